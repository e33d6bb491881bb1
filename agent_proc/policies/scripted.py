"""The scripted policy: chooses the push from which the push model predicts the best end, and stops if none helps.

It reads only the poses of the box and its goal, and is the baseline for learned policies.
"""

from itertools import product
from math import copysign
from typing import Final

import numpy as np
from msgspec.structs import replace

from agent_proc.frames.push_view import PushView
from agent_proc.push_model.model import MIRROR, PushModel
from legpush.arrays import Floats
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS, FrontLeg
from legpush.scene.scenario import Goal

OTHER_LEG: Final[dict[FrontLeg, FrontLeg]] = {"FL": "FR", "FR": "FL"}
FIRST_DEPTHS_M: Final = (0.02, 0.04, 0.06, 0.08, 0.10)
LATER_DEPTHS_M: Final = (0.04, 0.06, 0.08, 0.10)
LOOK_AHEADS_M: Final = (0.1, 0.2, 0.35, 0.6)
LEAST_DEPTH_M: Final = 0.02
N_DIGITS: Final = 9
"""The pose of the box is rounded to this many decimals of metres and radians."""
MAX_CYCLES: Final = 60
"""Largest number of push cycles that are predicted."""
REAL_OVER_MODEL: Final = ((1.0, 1.0), (1.2, 0.6), (1.2, 1.4), (0.8, 0.6), (0.8, 1.4))
"""Scales of the model's travel and turn; the cost of a candidate is its mean over these."""
CYCLE_COST: Final = 0.02
"""Cost of each push cycle, in tolerances of the final error."""
WEAVING_COST: Final = 0.2
"""Cost per radian of heading error after each push cycle: all ways to shift the box sideways cost the same, and
needless turning to and fro costs more."""
LEAST_GAIN: Final = 0.1
"""Smallest gain for which it pushes on, in tolerances: less is within the accuracy of the model."""


class ScriptedPolicy:
    """Predicts the final error for each leg, depth, later depth and look-ahead, and pushes as the best one begins.

    After the first push, a steering rule continues (pure pursuit of the line through the goal): the leg follows the
    sign of the heading error, and the depth never exceeds the remaining distance.
    """

    def __init__(self, model: PushModel | None = None) -> None:
        """Predict with `model`, or with the measured model of the default box."""
        self._model = PushModel() if model is None else model
        candidates = list(product(FRONT_LEGS, FIRST_DEPTHS_M, LATER_DEPTHS_M, LOOK_AHEADS_M))
        self._pushes = [
            Push(w1=self._model.w1, w2=self._model.w2, leg=leg, depth_m=depth) for leg, depth, _, _ in candidates
        ]
        n_models = len(REAL_OVER_MODEL)
        self._travel_scale, self._turn_scale = np.repeat(REAL_OVER_MODEL, len(candidates), axis=0).T
        self._mirror = np.tile([MIRROR[push.leg] for push in self._pushes], n_models)
        self._first_depth, self._later_depth, self._look_ahead = np.tile([c[1:] for c in candidates], (n_models, 1)).T

    def decide(self, view: PushView) -> Push | None:
        """The first push of the best candidate, or None if pushing on is not worth it."""
        push, cost, error = self.best(view)
        return None if cost > error - LEAST_GAIN else push

    def best(self, view: PushView) -> tuple[Push, float, float]:
        """The first push of the best candidate, its cost, and the present error, both in tolerances."""
        goal, box = view.goal, view.box_g
        # Decide for the box left of the line, so that mirror images get mirrored answers in spite of rounding.
        mirror = copysign(1.0, box.y_m or box.yaw_rad)
        row = np.round([[box.x_m, mirror * box.y_m, mirror * box.yaw_rad]], N_DIGITS)
        costs = self._costs(row, goal)
        best = int(costs.argmin())
        push = self._pushes[best]
        if view.lost_depth_m > 0.0:
            push = replace(push, depth_m=min(push.depth_m + view.lost_depth_m, FIRST_DEPTHS_M[-1]))
        if mirror < 0.0:
            push = replace(push, leg=OTHER_LEG[push.leg])
        return push, float(costs[best]), float(_error(row, goal)[0])

    def _costs(self, box: Floats, goal: Goal) -> Floats:
        """Cost of each candidate, (n,): least error along its prediction plus its cycles, averaged over the models.

        `box` is the pose of the box in the goal frame, (1, 3).
        """
        pose = np.repeat(box, len(self._mirror), axis=0)
        mirror, depth = self._mirror, self._first_depth
        costs, spent = np.full(len(pose), np.inf), np.zeros(len(pose))
        for _ in range(MAX_CYCLES):
            pose = self._model.push(pose, mirror, depth, self._travel_scale, self._turn_scale)
            spent += CYCLE_COST + WEAVING_COST * np.abs(pose[:, 2])
            costs = np.minimum(costs, _error(pose, goal) + spent)
            if (pose[:, 0] >= 0.0).all():
                break
            heading_error = np.arctan2(-pose[:, 1], self._look_ahead) - pose[:, 2]
            mirror = np.where(heading_error > 0.0, MIRROR["FR"], MIRROR["FL"])
            remaining = self._model.depth_for(np.maximum(-pose[:, 0], 0.0))
            depth = np.maximum(np.minimum(self._later_depth, remaining), LEAST_DEPTH_M)
        mean: Floats = costs.reshape(len(REAL_OVER_MODEL), -1).mean(axis=0)
        return mean


def _error(pose: Floats, goal: Goal) -> Floats:
    """Norm of the position and angle errors in tolerances, for poses in the goal frame, (n, 3) to (n,)."""
    position = np.hypot(pose[:, 0], pose[:, 1]) / goal.position_tolerance_m
    return np.hypot(position, np.degrees(pose[:, 2]) / goal.angle_tolerance_deg)
