"""Look-ahead over the push model: every sequence of the next pushes is predicted, and steering goes on from there.

After the first pushes, which may be any of a grid, the leg follows the sign of the steering error, and the depth the
remaining distance. The sequence with the least error along its prediction begins with the push that is taken.
"""

from itertools import product
from math import radians
from typing import Final

import numpy as np

from agent_proc.frames.push_view import LOOK_AHEAD_M, PushView
from agent_proc.policies.scripted import CYCLE_COST, MAX_CYCLES
from agent_proc.push_model.model import MIRROR, PushModel
from agent_proc.pushing.docking.moves import walk_s
from agent_proc.rivals.best_face import S_COST, measured_model
from agent_proc.rivals.steering import views_of_faces
from agent_proc.task.action import deepest_push_m, shallowest_push_m
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from legpush.arrays import Floats
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS

N_DEPTHS: Final = 5
"""Depths from the shallowest to the deepest push of the task."""
N_FREE: Final = 3
"""Pushes whose leg and depth are free."""


class LookAhead:
    """Predicts all sequences of `N_FREE` pushes over the measured response of the default box."""

    def __init__(self, task: TaskConfig) -> None:
        self._task = task

    def decide(self, view: PushView) -> Push | None:
        """The first push of the best sequence, or None if nothing is left to do."""
        if has_arrived(self._task, view):
            return None
        views = views_of_faces(view) if self._task.changes_face else {view.face: view}
        best = [(*self._best(there), there.face) for there in views.values()]
        _, push, _ = min(best, key=lambda each: each[0] + S_COST * walk_s(view.face, each[2]))
        return push

    def _best(self, view: PushView) -> tuple[float, Push]:
        """The least cost of pushes at the face of a view, and the push that it begins with."""
        depths = depths_m(self._task, view)
        choices = list(product(FRONT_LEGS, depths))
        sequences = np.array(
            [[(MIRROR[leg], depth_m) for leg, depth_m in each] for each in product(choices, repeat=N_FREE)]
        )
        costs = predicted_costs(view, measured_model(view.face), sequences, max(depths), min(depths))
        index = int(costs.argmin())
        leg, depth_m = choices[index // len(choices) ** (N_FREE - 1)]
        return float(costs[index]), Push(w1=0.5, w2=0.5, leg=leg, depth_m=depth_m, face=view.face)


def depths_m(task: TaskConfig, view: PushView) -> list[float]:
    """Depths of pushes that a task allows here, evenly spaced."""
    if task.entry == "fixed":
        return [task.fixed_depth_m]
    depths: list[float] = np.linspace(shallowest_push_m(task, view), deepest_push_m(task, view), N_DEPTHS).tolist()
    return depths


def predicted_costs(view: PushView, model: PushModel, sequences: Floats, deepest_m: float, least_m: float) -> Floats:
    """Least error in tolerances along each prediction, with the cost of its cycles, (n,).

    `sequences` has the sign of the leg and the depth of each free push, (n, pushes, 2).
    """
    box, goal, lost_m = view.box_g, view.goal, view.lost_depth_m
    poses = np.repeat([[box.x_m, box.y_m, box.yaw_rad]], len(sequences), axis=0)
    near = np.array([goal.position_tolerance_m, goal.position_tolerance_m, radians(goal.angle_tolerance_deg)])
    costs = np.full(len(poses), np.inf)
    for cycle in range(1, MAX_CYCLES + 1):
        if cycle <= sequences.shape[1]:
            mirror, depth_m = sequences[:, cycle - 1].T
            yielded_m = np.maximum(depth_m - lost_m, 0.0)
        else:
            error_rad = np.arctan2(-poses[:, 1], LOOK_AHEAD_M) - poses[:, 2]
            mirror = np.where(error_rad > 0.0, MIRROR["FR"], MIRROR["FL"])
            wanted_m = model.depth_for(np.maximum(-poses[:, 0], 0.0))
            yielded_m = np.clip(wanted_m, max(least_m - lost_m, 0.0), max(deepest_m - lost_m, 0.0))
        poses = model.push(poses, mirror, yielded_m)
        costs = np.minimum(costs, np.linalg.norm(poses / near, axis=1) + CYCLE_COST * cycle)
        if (poses[:, 0] >= 0.0).all():
            break
    return costs
