"""Estimates what a push does to this box: the push model, scaled by the effects of the pushes up to now.

A heavy box, or one on an upward slope, yields later: foot and leg give way until the force is large enough, and only
the rest of the depth moves the box. That lost depth is nearly the same at every depth, so it is estimated apart from
the scales. It decides how deep the last, short pushes have to be.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from agent_proc.push_model.model import MIRROR, PushModel, nearest_model
from agent_proc.push_model.response import Response, ResponseEstimate, expected_turn_scale
from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.common import USUAL_DEPTH_M
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.scenario import Box

PRIOR_M: Final = 0.03
PRIOR_RAD: Final = 0.05
"""Weight of the prior: it counts as much as pushes whose travel (or turn) has this root sum of squares."""
FORGETTING: Final = 0.9
"""Factor on the weight of past pushes after each further one."""
LOST_PRIOR: Final = 0.05
"""Weight of the prior of the lost depth, which is 0."""
LOST_FORGETTING: Final = 0.8
"""Factor on the weight of past lost depths after each further push."""
LOST_SD_M: Final = 0.0005
LOST_SD_SHARE: Final = 0.04
"""Standard deviation of a measured lost depth, and the part of it that grows with the depth: curves differ."""
LEAST_MOVED_M: Final = 0.0005
"""A push that moves the box by less says only that at least its depth was lost."""
LEAST_LOST_M: Final = 0.002
"""A smaller estimate counts as no lost depth: boxes of up to 0.9 kg on a level floor lose less."""
DRIFT_FORGETTING: Final = 0.7
"""Factor on the weight of past drifts after each further push."""
PATH_DEPTH_M: Final = 0.065
"""Mean depth of the pushes along a path: the policy pushes straight ahead with up to 10 cm, arcs take 5 and 8 cm."""
LEAST_TRAVEL_SHARE: Final = 0.1
MOST_AXLE_M: Final = 0.5
LEAST_SCALE: Final = 0.3
MOST_SCALE: Final = 3.0


Drift = tuple[float, float, float]
"""Forward [m], left [m] and turn [rad] by one push, in the pushed frame."""


@dataclass(frozen=True, kw_only=True)
class FeltBox:
    """What the pushes up to now have shown of a box."""

    lost_depth_m: float = 0.0
    """How much deeper this box has to be pushed than the default one to move as far."""
    drift: Drift = (0.0, 0.0, 0.0)
    """What the last pushes did beyond what the model expected of them."""
    response: Response | None = None
    """What a push does; None if nothing is known but the size of the box."""
    n_pushes: tuple[int, int] = (0, 0)
    """How many pushes of FL and FR have shown it."""


class PushEstimate:
    """Scales of travel and turn by least squares over the observed pushes, with the model as prior."""

    def __init__(self, box: Box, model: PushModel | None = None) -> None:
        """Begin with `model`, or with the nearest measured one; `box` has its size in the pushed frame."""
        self._model = nearest_model(box) if model is None else model
        self._turn_prior = expected_turn_scale(box, self._model)
        self._response = ResponseEstimate(box, self._model)
        self._travel = np.array([PRIOR_M**2, PRIOR_M**2])
        """Sums of measured times predicted, and of predicted squared."""
        self._turn = np.array([PRIOR_RAD**2, PRIOR_RAD**2])
        self._lost = np.array([0.0, LOST_PRIOR])
        """Sums of weights times lost depths, and of weights; a weight is that of one push with `LOST_SD_M`."""
        self._n_pushes = [0, 0]
        self._drift = np.zeros(4)
        """Sums of weights times forward, left and turn beyond those of the model, and of weights."""

    @property
    def curve(self) -> tuple[float, float]:
        """w1 and w2 of the pushes that the model describes."""
        return self._model.w1, self._model.w2

    @property
    def travel_scale(self) -> float:
        """Travel of the box divided by that of the model."""
        return float(np.clip(self._travel[0] / self._travel[1], LEAST_SCALE, MOST_SCALE))

    @property
    def turn_scale(self) -> float:
        """Turn of the box divided by that of the model."""
        return self._turn_prior * float(np.clip(self._turn[0] / self._turn[1], LEAST_SCALE, MOST_SCALE))

    @property
    def lost_depth_m(self) -> float:
        """How much deeper than in the model a push has to be to move this box as far; 0 if it yields at once."""
        lost_m = float(self._lost[0] / self._lost[1])
        return lost_m if lost_m >= LEAST_LOST_M else 0.0

    @property
    def felt(self) -> FeltBox:
        """What a decision about a push may depend on."""
        return FeltBox(
            lost_depth_m=self.lost_depth_m,
            drift=self.drift,
            response=self._response.response,
            n_pushes=(self._n_pushes[0], self._n_pushes[1]),
        )

    @property
    def drift(self) -> Drift:
        """Forward [m], left [m] and turn [rad] of the last pushes beyond those of the model, as a weighted mean.

        Each push counts whatever its curve is; of the depth, only what this box yields to.
        """
        forward_m, left_m, turn_rad, weight = self._drift.tolist()
        return (forward_m / weight, left_m / weight, turn_rad / weight) if weight else (0.0, 0.0, 0.0)

    @property
    def usual_travel_m(self) -> float:
        """How far a push of the usual depth moves this box, at least a tenth of how far it moves that of the model."""
        return self._travel_m(USUAL_DEPTH_M)

    @property
    def path_travel_m(self) -> float:
        """How far a push along a path moves this box, with the mean depth of such pushes."""
        return self._travel_m(PATH_DEPTH_M)

    @property
    def turning_radius_m(self) -> float:
        """Radius of the circle on which the same foot pushes the box, at the usual depth."""
        forward_m, _, turn_rad = self._one_push()
        return forward_m / turn_rad

    @property
    def axle_m(self) -> float:
        """Distance of the axle behind the centre: the point that does not slip sideways when one foot turns the box."""
        _, left_m, turn_rad = self._one_push()
        return float(np.clip(left_m / turn_rad, 0.0, MOST_AXLE_M))

    def _one_push(self) -> tuple[float, float, float]:
        """Displacement forward and left [m] and turn [rad] of the box by one push of FR, at the usual depth."""
        ((forward_m, left_m, turn_rad),) = self.push(
            np.zeros((1, 3)), np.array([MIRROR["FR"]]), np.array([USUAL_DEPTH_M])
        ).tolist()
        return forward_m, left_m, turn_rad

    def push(self, poses: Floats, mirror: Floats, depth_m: Floats) -> Floats:
        """Poses (x, y, yaw) after one push each, (n, 3); arguments as in `PushModel.push`."""
        return self._model.push(poses, mirror, depth_m, self.travel_scale, self.turn_scale)

    def _travel_m(self, depth_m: float) -> float:
        travel_m = self.travel_scale * self.commanded_m(depth_m - self.lost_depth_m)
        return max(travel_m, LEAST_TRAVEL_SHARE * self.commanded_m(depth_m))

    def commanded_m(self, depth_m: float) -> float:
        """How far a push of this depth moves the box of the model."""
        return float(np.interp(depth_m, self._model.depth_m, self._model.forward_m))

    def after(self, pose: Pose2, push: Push) -> Pose2:
        """Pose after one push."""
        row = np.array([[pose.x_m, pose.y_m, pose.yaw_rad]])
        ((x_m, y_m, yaw_rad),) = self.push(row, np.array([MIRROR[push.leg]]), np.array([push.depth_m])).tolist()
        return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)

    def learn(self, before: Pose2, push: Push, after: Pose2) -> None:
        """Update the estimates with the effect of a push.

        Scales ignore a push with another curve than the model's: it turns the box differently. `before` and `after` are
        poses of the pushed frame.
        """
        moved = before.inverse() @ after
        self._n_pushes[FRONT_LEGS.index(push.leg)] += 1
        yielded_m = max(0.0, push.depth_m - self.lost_depth_m)
        self._learn_drift(push, yielded_m, moved)
        self._learn_lost_depth(push.depth_m, moved.x_m)
        self._response.learn(push, moved)
        if (push.w1, push.w2) != self.curve:
            return
        row = np.zeros((1, 3))
        mirror, depth_m = np.array([MIRROR[push.leg]]), np.array([push.depth_m])
        ((x_m, _, yaw_rad),) = self._model.push(row, mirror, depth_m, turn_scale=self._turn_prior).tolist()
        for sums, prior, measured, predicted in (
            (self._travel, PRIOR_M, moved.x_m, x_m),
            (self._turn, PRIOR_RAD, wrap_angle(moved.yaw_rad), yaw_rad),
        ):
            sums -= (1.0 - FORGETTING) * (sums - prior**2)
            sums += np.array([measured * predicted, predicted * predicted])

    def _learn_drift(self, push: Push, yielded_m: float, moved: Pose2) -> None:
        mirror, depth_m = np.array([MIRROR[push.leg]]), np.array([yielded_m])
        ((x_m, y_m, yaw_rad),) = self._model.push(np.zeros((1, 3)), mirror, depth_m).tolist()
        beyond = [moved.x_m - x_m, moved.y_m - y_m, wrap_angle(moved.yaw_rad - yaw_rad), 1.0]
        self._drift = DRIFT_FORGETTING * self._drift + np.array(beyond)

    def _learn_lost_depth(self, depth_m: float, moved_m: float) -> None:
        """A box that hardly moved may have needed still more depth: then the estimate does not shrink."""
        lost_m = depth_m - float(self._model.depth_for(np.array([max(moved_m, 0.0)]))[0])
        if moved_m < LEAST_MOVED_M:
            lost_m = max(lost_m, self.lost_depth_m)
        weight = (LOST_SD_M / (LOST_SD_M + LOST_SD_SHARE * depth_m)) ** 2
        self._lost = LOST_FORGETTING * self._lost + weight * np.array([lost_m, 1.0])
