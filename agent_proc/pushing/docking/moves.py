"""What a push or a walk around the box does while docking, and how long it takes."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, pi, sin
from typing import Final

import numpy as np

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.model import MIRROR
from legpush.geometry import Pose2, wrap_angle
from legpush.scene.conventions import FRONT_LEGS, FrontLeg
from legpush.scene.faces import TURN_RAD
from legpush.scene.names import Face

DEPTHS_M: Final = (0.012, 0.02, 0.03, 0.05, 0.08)
"""Depths that pushes choose from, beyond the depth that a heavy box loses."""
DEEPEST_M: Final = 0.12
"""The deepest push whose effect was measured."""
PUSH_S: Final = 2.9
"""A push cycle takes 2.7 to 3.0 s of simulated time."""
QUARTER_S: Final = 27.0
"""A walk to a face beside the present one takes 22 to 37 s: back, around a corner of the box, and up to the face."""
HALF_S: Final = 32.0
"""A walk to the opposite face takes 30 to 33 s."""


@dataclass(frozen=True, kw_only=True)
class DockPush:
    """A push at a face, and the displacement of the box by it, in the frame of the box before."""

    face: Face
    leg: FrontLeg
    depth_m: float
    x_m: float
    y_m: float
    yaw_rad: float

    def after(self, box: Pose2) -> Pose2:
        """Return where the box is after the push."""
        c, s = cos(box.yaw_rad), sin(box.yaw_rad)
        return Pose2(
            x_m=box.x_m + c * self.x_m - s * self.y_m,
            y_m=box.y_m + s * self.x_m + c * self.y_m,
            yaw_rad=wrap_angle(box.yaw_rad + self.yaw_rad),
        )


@dataclass(frozen=True, kw_only=True)
class DockWalk:
    """A walk around the box to another face."""

    face: Face


DockMove = DockPush | DockWalk


def dock_pushes(estimates: Mapping[Face, PushEstimate]) -> dict[Face, tuple[DockPush, ...]]:
    """Return the pushes at each face, with both legs, by what is known of this box up to now."""
    return {
        face: tuple(
            _push(face, estimate, leg, depth_m)
            for leg in FRONT_LEGS
            for depth_m in sorted({min(depth_m + estimate.lost_depth_m, DEEPEST_M) for depth_m in DEPTHS_M})
        )
        for face, estimate in estimates.items()
    }


def walk_s(present: Face | None, to: Face) -> float:
    """Return the duration of a walk to a face, from the present one or from anywhere near the box."""
    if present is None:
        return QUARTER_S
    turn_rad = abs(wrap_angle(TURN_RAD[to] - TURN_RAD[present]))
    return QUARTER_S + (HALF_S - QUARTER_S) * (2 * turn_rad / pi - 1.0) if turn_rad else 0.0


def _push(face: Face, estimate: PushEstimate, leg: FrontLeg, depth_m: float) -> DockPush:
    yielded_m = np.array([depth_m - estimate.lost_depth_m])
    ((x_m, y_m, yaw_rad),) = estimate.push(np.zeros((1, 3)), np.array([MIRROR[leg]]), yielded_m).tolist()
    c, s = cos(TURN_RAD[face]), sin(TURN_RAD[face])
    return DockPush(face=face, leg=leg, depth_m=depth_m, x_m=c * x_m - s * y_m, y_m=s * x_m + c * y_m, yaw_rad=yaw_rad)
