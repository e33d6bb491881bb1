"""Pushes as the value table says, for the response that this very box has shown up to now."""

from functools import lru_cache
from math import radians
from typing import Final

import numpy as np

from agent_proc.frames.push_view import PushView
from agent_proc.policies.dynamic_programming.value_table import Problem, ValueTable
from agent_proc.push_model.model import MIRROR
from agent_proc.push_model.response import Response
from legpush.arrays import Flags, Floats
from legpush.messages.stepping import Push

LEAST_M: Final = 0.005
MOST_M: Final = 0.10
"""Depths of pushes: those of the task `tuned`."""
FIRST_M: Final = 0.05
"""The first push of each leg at a face is no deeper: a box may be heavy, and what resists is felt by pushing it."""
LEAST_RANGE_M: Final = 0.01
"""A box that loses nearly the whole depth is pushed with depths that differ by this much at least."""
N_CHOICES: Final = 24
"""Depths among which a push chooses."""
LEAST_GAIN: Final = 0.01
"""Smallest gain for which it pushes, in tolerances: the cost of a push cycle."""
N_TABLES: Final = 16
"""Tables that are kept."""


class DynamicProgramming:
    """Takes the push of the least cost, or stops where none costs less than the error that is left.

    Equal views give equal decisions: all that it knows of the box is in the view.
    """

    def __init__(self, least_m: float = LEAST_M, most_m: float = MOST_M) -> None:
        """Push with depths between these, beyond what this box loses, and at most with the second one."""
        self._least_m = least_m
        self._most_m = most_m

    def decide(self, view: PushView) -> Push | None:
        """The next push, or None if no push is worth its cost."""
        push, cost, error = self.best(view)
        return None if cost > error - LEAST_GAIN else push

    def best(self, view: PushView) -> tuple[Push, float, float]:
        """The push of the least cost, that cost, and the present error, both in tolerances."""
        response = view.response
        lost_m = view.lost_depth_m if view.felt.response is None else response.lost_depth_m
        problem = self._problem(view, response, lost_m)
        table = _table(problem)
        mirror, depth_m = problem.pushes(N_CHOICES)
        if view.felt.response is not None:
            first = _first(view.felt.n_pushes, mirror, depth_m)
            mirror, depth_m = mirror[first], depth_m[first]
        box = view.box_g
        costs = table.costs((box.x_m, box.y_m, box.yaw_rad), response, mirror, depth_m)
        index = int(costs.argmin())
        push = Push(
            w1=response.w1,
            w2=response.w2,
            leg="FL" if mirror[index] > 0.0 else "FR",
            depth_m=min(float(depth_m[index]) + lost_m, self._most_m),
            face=view.face,
        )
        (error,) = problem.error(*np.array([[box.x_m], [box.y_m], [box.yaw_rad]])).tolist()
        return push, float(costs[index]), error

    def _problem(self, view: PushView, response: Response, lost_m: float) -> Problem:
        goal = view.goal
        return Problem(
            response=response,
            least_m=self._least_m,
            most_m=max(self._most_m - lost_m, self._least_m + LEAST_RANGE_M),
            near_m=goal.position_tolerance_m,
            near_rad=radians(goal.angle_tolerance_deg),
        )


def _first(n_pushes: tuple[int, int], mirror: Floats, depth_m: Floats) -> Flags:
    """Which pushes may be the next one, (n,), after these numbers of pushes of FL and FR at the face.

    The first push of each leg is shallow, and that of the other leg comes second. One leg may not be able to turn the
    box back, and that has to be known before the other leg has turned it too far.
    """
    if 0 not in n_pushes:
        return np.ones(len(depth_m), dtype=bool)
    shallow: Flags = depth_m <= FIRST_M
    untried = MIRROR["FL" if n_pushes[0] == 0 else "FR"]
    return shallow & (mirror == untried) if any(n_pushes) else shallow


@lru_cache(maxsize=N_TABLES)
def _table(problem: Problem) -> ValueTable:
    return ValueTable(problem)
