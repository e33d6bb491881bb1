"""Measured displacement of the box by one push cycle, which the scripted policy predicts with."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from agent_proc.push_model.curve_terms import Terms, curve_terms
from legpush.arrays import Floats
from legpush.messages.stepping import Push
from legpush.scene.scenario import Box, PoseDeg

MIRROR: Final = {"FL": 1.0, "FR": -1.0}
NOMINAL: Final = Box(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0))
"""The default box."""


@dataclass(frozen=True, kw_only=True)
class PushModel:
    """Displacement of the box by one push cycle of FL, by depth; FR does the mirror image.

    Rows begin at depth 0 and are interpolated linearly. Measured by the study `push_effect` with a box of 0.1 kg
    at friction 0.5.
    """

    box: Box = NOMINAL
    """The box that was pushed."""
    w1: float = 0.5
    w2: float = 0.5
    """The curve that the rows were measured with."""
    depth_m: tuple[float, ...] = (0.0, 0.005, 0.01, 0.02, 0.03, 0.05, 0.08, 0.1, 0.12)
    forward_m: tuple[float, ...] = (0.0, 0.0017, 0.0056, 0.0135, 0.0212, 0.0366, 0.0596, 0.0747, 0.0899)
    """Displacement of the box's centre along the x axis that the box had before."""
    left_m: tuple[float, ...] = (0.0, -0.0001, -0.0011, -0.0033, -0.0059, -0.0104, -0.0151, -0.0215, -0.0268)
    """The same along its y axis."""
    turn_deg: tuple[float, ...] = (0.0, -0.21, -0.62, -1.43, -2.31, -4.07, -6.77, -8.41, -10.04)
    curve: tuple[Terms, Terms, Terms] = (
        (0.0058, 0.016, -0.0465, -0.031, -0.1204),
        (0.0289, -0.0108, 0.0694, 0.0041, 0.1785),
        (-0.004, 0.1731, -0.4427, -0.221, -0.933),
    )
    """How other values of w1 and w2 change forward [m], left [m] and turn [rad] of FL, per metre of depth: coefficients
    of `CURVE_TERMS`, those of the response map of the default box."""

    def push(
        self,
        pose: Floats,
        mirror: Floats,
        depth_m: Floats,
        travel_scale: ArrayLike = 1.0,
        turn_scale: ArrayLike = 1.0,
    ) -> Floats:
        """Poses (x, y, yaw) of the box after one push cycle each, (n, 3).

        `mirror` is 1 for FL and -1 for FR, (n,); the scales multiply the rows, scalar or (n,).
        """
        forward = np.multiply(travel_scale, np.interp(depth_m, self.depth_m, self.forward_m))
        left = np.multiply(travel_scale, mirror * np.interp(depth_m, self.depth_m, self.left_m))
        turn = np.multiply(turn_scale, mirror * np.radians(np.interp(depth_m, self.depth_m, self.turn_deg)))
        c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        after: Floats = pose + np.stack([c * forward - s * left, s * forward + c * left, turn], axis=1)
        return after

    def beyond_usual_curve(self, push: Push, depth_m: Floats) -> tuple[Floats, Floats, Floats]:
        """How much further a push moves the box forward and left [m], and turns it [rad], than one with w1 and w2 of
        the model, (n,) each; `depth_m` is the part of its depth that moves the box, (n,).
        """
        theirs, mine = (curve_terms(np.array(w1), np.array(w2)) for w1, w2 in ((push.w1, push.w2), (self.w1, self.w2)))
        more = [float(b) - float(a) for a, b in zip(mine, theirs, strict=True)]
        forward, left, turn = (
            depth_m * sum(c * each for c, each in zip(terms, more, strict=True)) for terms in self.curve
        )
        mirror = MIRROR[push.leg]
        return forward, mirror * left, mirror * turn

    def depth_for(self, forward_m: Floats) -> Floats:
        """The depth that moves the box by `forward_m`, limited to the deepest measured one, (n,)."""
        depth: Floats = np.interp(forward_m, self.forward_m, self.depth_m)
        return depth


ON_ITS_SIDE: Final = PushModel(
    box=Box(pose=NOMINAL.pose, size_m=(0.5, 0.4, 0.4)),
    forward_m=(0.0, 0.0022, 0.0066, 0.0158, 0.0248, 0.0423, 0.0685, 0.0846, 0.1016),
    left_m=(0.0, -0.0004, -0.0019, -0.0049, -0.008, -0.0143, -0.0248, -0.0289, -0.0353),
    turn_deg=(0.0, -0.14, -0.37, -0.78, -1.26, -2.36, -3.93, -5.63, -6.7),
    curve=(
        (-0.0022, 0.0064, -0.039, -0.0348, -0.1062),
        (0.0419, -0.012, 0.083, 0.0317, 0.1504),
        (-0.0605, 0.1287, -0.4088, -0.3124, -0.8622),
    ),
)
"""Model of the default box, pushed at its left or right face."""


def nearest_model(box: Box) -> PushModel:
    """The measured model of the box with the nearest ratio of width to length; `box` is in the pushed frame."""
    slenderness = np.log(box.size_m[1] / box.size_m[0])
    models = (PushModel(), ON_ITS_SIDE)
    return min(models, key=lambda model: abs(np.log(model.box.size_m[1] / model.box.size_m[0]) - slenderness))
