"""What one push does to a box: the push model, with curves that are fitted to the pushes up to now.

In the model the legs do mirror images of each other, and displacements have one shape over the depth. A centre of mass
beside the middle, or a slope across the way, makes the legs differ. A round or heavy box yields less and less as a push
goes on, and turns more and more. A heavy box yields nothing at first: that lost depth is taken to be the same at every
depth and for both legs. Curves are fitted for each of several lost depths, and those are taken that made the pushes up
to now most likely.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from agent_proc.push_model.curves import Curves, Part, Spread
from agent_proc.push_model.model import MIRROR, PushModel, nearest_model
from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.scenario import Box

LOST_STEP_M: Final = 0.0025
MOST_LOST_M: Final = 0.07
LOST_M: Final[Floats] = LOST_STEP_M * np.arange(round(MOST_LOST_M / LOST_STEP_M) + 1, dtype=np.float64)
"""Lost depths that are compared."""


@dataclass(frozen=True, kw_only=True)
class Kind:
    """What is known of the response of boxes of a kind before the first push."""

    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """How much further than in the model they move forward and left, and turn, on the mean."""
    forward: Spread
    left: Spread
    turn: Spread
    lost_mean_m: float
    """Mean of their lost depths."""


# Standard deviations, powers, reaches and noises are rounded from the most likely ones for 2 x 24 pushes each of random
# boxes of level 2: 48 with corners and 82 cylinders, of seeds that no evaluation has. Those of boxes with corners are
# widened for slopes and sensors, which those pushes were without, and a longer reach to the left keeps curves smooth.
CORNERED: Final = Kind(
    forward=Spread(
        common=Part(sd=0.015, power=0.8, reach_m=1.0),
        opposite=Part(sd=0.005, power=1.2, reach_m=1.0),
        noise=0.002,
        deep_noise=0.001,
        noise_power=2.0,
    ),
    left=Spread(
        common=Part(sd=0.012, power=0.9, reach_m=2.0),
        opposite=Part(sd=0.01, power=1.0, reach_m=1.0),
        noise=0.0025,
        deep_noise=0.001,
        noise_power=1.0,
    ),
    turn=Spread(
        common=Part(sd=0.06, power=1.2, reach_m=1.0),
        opposite=Part(sd=0.06, power=1.0, reach_m=1.0),
        noise=0.005,
        deep_noise=0.005,
        noise_power=1.5,
    ),
    lost_mean_m=0.01,
)
ROUND: Final = Kind(
    scale=(0.7, 1.1, 1.4),
    forward=Spread(
        common=Part(sd=0.03, power=1.2, reach_m=0.5),
        opposite=Part(sd=0.0065, power=0.85, reach_m=0.055),
        noise=0.001,
        deep_noise=0.0055,
        noise_power=1.4,
    ),
    left=Spread(
        common=Part(sd=0.015, power=1.0, reach_m=0.37),
        opposite=Part(sd=0.0045, power=0.65, reach_m=0.09),
        noise=0.001,
        deep_noise=0.0035,
        noise_power=1.35,
    ),
    turn=Spread(
        common=Part(sd=0.17, power=1.25, reach_m=0.36),
        opposite=Part(sd=0.105, power=0.95, reach_m=0.25),
        noise=0.005,
        deep_noise=0.05,
        noise_power=1.55,
    ),
    lost_mean_m=0.003,
)


@dataclass(frozen=True, kw_only=True)
class Curve:
    """What pushes of one leg do, at the depths of the model: those of FL, or the mirror image of those of FR."""

    forward_m: tuple[float, ...]
    left_m: tuple[float, ...]
    turn_rad: tuple[float, ...]
    turn_sd_rad: tuple[float, ...]
    """Standard deviation of the turn around that."""


@dataclass(frozen=True, kw_only=True)
class Response:
    """Displacement of a box by one push, in the pushed frame before it."""

    depth_m: tuple[float, ...]
    curves: tuple[Curve, Curve]
    """Those of FL and FR."""
    w1: float
    w2: float
    lost_depth_m: float = 0.0
    """What is lost of the depth of a push before the box yields."""

    def displacement(self, mirror: Floats, depth_m: Floats) -> tuple[Floats, Floats, Floats]:
        """Forward [m], left [m] and turn [rad], (n,) each; arguments as in `PushModel.push`, without lost depth."""
        fl, fr = self.curves
        forward = self._of(mirror, depth_m, fl.forward_m, fr.forward_m)
        left = mirror * self._of(mirror, depth_m, fl.left_m, fr.left_m)
        return np.maximum(forward, 0.0), left, mirror * self._of(mirror, depth_m, fl.turn_rad, fr.turn_rad)

    def turn_sd_rad(self, mirror: Floats, depth_m: Floats) -> Floats:
        """Standard deviation of the turn, (n,)."""
        fl, fr = self.curves
        return self._of(mirror, depth_m, fl.turn_sd_rad, fr.turn_sd_rad)

    def _of(self, mirror: Floats, depth_m: Floats, fl: tuple[float, ...], fr: tuple[float, ...]) -> Floats:
        first, second = np.interp(depth_m, self.depth_m, fl), np.interp(depth_m, self.depth_m, fr)
        return np.where(mirror == MIRROR["FL"], first, second)


class ResponseEstimate:
    """Fits a response to pushes, beginning with what is expected of a box; it has its size in the pushed frame."""

    def __init__(self, box: Box, model: PushModel, *, lost_m: Floats = LOST_M) -> None:
        """Compare the lost depths `lost_m`, (n,)."""
        self._model, self._lost_m = model, lost_m
        depth_m, kind = np.array(model.depth_m), kind_of(box)
        self._forward, self._left, self._turn = (
            Curves(depth_m, expected, spread, len(lost_m))
            for expected, spread in zip(expected_curves(box, model), (kind.forward, kind.left, kind.turn), strict=True)
        )
        self._likelihoods = -lost_m / kind.lost_mean_m

    @property
    def response(self) -> Response:
        """The present estimate: that of the most likely lost depth."""
        fit = int(self._likelihoods.argmax())
        rows = (*(each.values(fit) for each in (self._forward, self._left, self._turn)), self._turn.sd(fit))
        fl, fr = (
            Curve(forward_m=tuple(f), left_m=tuple(left), turn_rad=tuple(turn), turn_sd_rad=tuple(sd))
            for f, left, turn, sd in zip(*(row.tolist() for row in rows), strict=True)
        )
        model, lost_m = self._model, float(self._lost_m[fit])
        return Response(depth_m=model.depth_m, curves=(fl, fr), w1=model.w1, w2=model.w2, lost_depth_m=lost_m)

    def learn(self, push: Push, moved: Pose2) -> None:
        """Update the curves with what a push did, in the pushed frame before it.

        What w1 and w2 other than those of the model are expected to add is taken away.
        """
        leg, mirror = FRONT_LEGS.index(push.leg), MIRROR[push.leg]
        depth_m = np.maximum(push.depth_m - self._lost_m, 0.0)
        forward, left, turn = self._model.beyond_usual_curve(push, depth_m)
        self._likelihoods += self._forward.learn(leg, depth_m, moved.x_m - forward)
        self._left.learn(leg, depth_m, mirror * (moved.y_m - left))
        self._turn.learn(leg, depth_m, mirror * (wrap_angle(moved.yaw_rad) - turn))


def expected_response(box: Box, model: PushModel | None = None) -> Response:
    """The response of a box that has not been pushed, over `model` or the nearest measured one.

    `box` has its size in the pushed frame.
    """
    model = nearest_model(box) if model is None else model
    return ResponseEstimate(box, model, lost_m=np.zeros(1)).response


def expected_turn_scale(box: Box, model: PushModel) -> float:
    """How much more a push turns a box than that of the model; both have their size in the pushed frame."""
    return _turn_per_travel(box) / _turn_per_travel(model.box)


def kind_of(box: Box) -> Kind:
    """The kind of a box by its size: it may be round if both sides are equal. What its shape is, nobody tells."""
    return ROUND if box.size_m[0] == box.size_m[1] else CORNERED


def expected_curves(box: Box, model: PushModel) -> tuple[Floats, Floats, Floats]:
    """Forward [m], left [m] and turn [rad] by the depths of `model`, (n,) each, of a box before its first push."""
    forward, left, turn = kind_of(box).scale
    turn_scale = turn * expected_turn_scale(box, model)
    return forward * np.array(model.forward_m), left * np.array(model.left_m), turn_scale * np.radians(model.turn_deg)


def _turn_per_travel(box: Box) -> float:
    """Turn per travel [1/m] of a box that is pushed at the usual share of its width, up to a constant factor.

    It assumes a box that rests on its corners: a push turns it in proportion to the arm of the push over the squared
    distance of the corners from the centre.
    """
    length_m, width_m, _ = box.size_m
    return width_m / (length_m**2 + width_m**2)
