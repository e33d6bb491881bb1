"""The scripted policy: pushes the way that a push model predicts to end best, and stops where none ends better.

It looks at nothing but the box and its goal, and is the baseline that learned policies are measured against.
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
from legpush.scene.robot import FRONT_LEGS, FrontLeg
from legpush.scene.scenario import Goal

OTHER_LEG: Final[dict[FrontLeg, FrontLeg]] = {"FL": "FR", "FR": "FL"}
FIRST_DEPTHS_M: Final = (0.02, 0.04, 0.06, 0.08, 0.10)
LATER_DEPTHS_M: Final = (0.04, 0.06, 0.08, 0.10)
LOOK_AHEADS_M: Final = (0.1, 0.2, 0.35, 0.6)
LEAST_DEPTH_M: Final = 0.02
N_DIGITS: Final = 9
"""The box's pose is looked at to this many decimals of metres and radians."""
MAX_CYCLES: Final = 60
"""How many push cycles are predicted at most."""
REAL_OVER_MODEL: Final = ((1.0, 1.0), (1.2, 0.6), (1.2, 1.4), (0.8, 0.6), (0.8, 1.4))
"""Travel and turn of the box as shares of the model's: each candidate has to do well on average over these."""
CYCLE_COST: Final = 0.02
"""What each push cycle has to gain, in tolerances of the final error."""
WEAVING_COST: Final = 0.2
"""The same per radian that the box is turned away from the goal's heading after it: all ways to shift the box sideways
cost alike, needless turning to and fro costs more."""
LEAST_GAIN: Final = 0.1
"""What pushing on has to gain at all, in tolerances: less is within what the model knows."""


class ScriptedPolicy:
    """For each leg, depth, later depth and look-ahead: with what error would the box end? The best one begins now.

    After the push in question a steering rule goes on (pure pursuit of the line through the goal): the leg follows the
    sign of the heading error, and the depth never exceeds the remaining distance.
    """

    def __init__(self, model: PushModel | None = None) -> None:
        """Decide by `model`; the measured one unless another is given."""
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
        goal, box = view.goal, view.box_g
        # Decided for the box left of the line, so that mirror images get mirrored answers however numbers are rounded.
        mirror = copysign(1.0, box.y_m or box.yaw_rad)
        row = np.round([[box.x_m, mirror * box.y_m, mirror * box.yaw_rad]], N_DIGITS)
        costs = self._costs(row, goal)
        best = int(costs.argmin())
        if costs[best] > _error(row, goal)[0] - LEAST_GAIN:
            return None
        push = self._pushes[best]
        return push if mirror > 0.0 else replace(push, leg=OTHER_LEG[push.leg])

    def _costs(self, box: Floats, goal: Goal) -> Floats:
        """Of each candidate: least error on its predicted way and what its cycles cost, mean over the models, (n,).

        `box` is its pose in the goal frame, (1, 3).
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
    """Position and angle errors of poses in the goal frame, each in tolerances, as one number, (n, 3) to (n,)."""
    position = np.hypot(pose[:, 0], pose[:, 1]) / goal.position_tolerance_m
    return np.hypot(position, np.degrees(pose[:, 2]) / goal.angle_tolerance_deg)
