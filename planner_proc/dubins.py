"""Forward paths with a minimum turning radius, searched with OMPL among what the box and the robot must not touch."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from legpush.geometry import Pose2
from legpush.messages import BoxPathQuery, Point2
from planner_proc.route import Budget, tree_of

Floats = NDArray[np.float64]
Fits = Callable[[Floats], bool]
"""Whether poses, (n, 3), are all allowed."""

SAMPLE_M: Final = 0.025
"""Between two poses of a path that is checked, and of one that is returned."""
N_SHORTCUTS: Final = 120
"""Attempts to shorten a path that the search found."""
LEAST_GAIN_M: Final = 0.01
"""What one of them has to gain."""
_SAME_M: Final = 1e-6


@dataclass(frozen=True, kw_only=True)
class DubinsRoute:
    """What the search found; key poses are joined by the shortest forward paths."""

    keys: tuple[Pose2, ...]
    """From start to goal; empty where nothing was found."""
    tree_points_m: tuple[Point2, ...]
    tree_parents: tuple[int, ...]
    n_iterations: int


class Dubins:
    """Shortest forward paths between poses, with a minimum turning radius."""

    def __init__(self, min_turning_radius_m: float) -> None:
        self.space = ob.DubinsStateSpace(min_turning_radius_m)
        bounds = ob.RealVectorBounds(2)
        bounds.setLow(-1e7)
        bounds.setHigh(1e7)
        self.space.setBounds(bounds)
        self._a, self._b, self._at = (self.space.allocState() for _ in range(3))

    def length_m(self, a: Pose2, b: Pose2) -> float:
        """Of the path from one pose to another."""
        self._set(a, b)
        return float(self.space.distance(self._a, self._b))

    def poses(self, a: Pose2, b: Pose2) -> Floats:
        """The path, `SAMPLE_M` or less apart, both ends included, (n, 3)."""
        self._set(a, b)
        return self.sampled(self._a, self._b)

    def sampled(self, a: Any, b: Any) -> Floats:
        """The same between two states of OMPL."""
        n = max(1, ceil(self.space.distance(a, b) / SAMPLE_M))
        poses = np.empty((n + 1, 3))
        at = self._at
        for k in range(n + 1):
            self.space.interpolate(a, b, k / n, at)
            poses[k] = at.getX(), at.getY(), at.getYaw()
        return poses

    def path(self, keys: tuple[Pose2, ...]) -> Floats:
        """All of the path over key poses, (n, 3)."""
        stretches = [self.poses(a, b) for a, b in pairwise(keys)]
        return np.concatenate([stretches[0], *(stretch[1:] for stretch in stretches[1:])])

    def _set(self, a: Pose2, b: Pose2) -> None:
        for state, pose in ((self._a, a), (self._b, b)):
            set_state(state, pose)


def set_state(state: Any, pose: Pose2) -> None:
    """Write a pose into a state of OMPL."""
    state.setX(pose.x_m)
    state.setY(pose.y_m)
    state.setYaw(pose.yaw_rad)


def search(query: BoxPathQuery, goal: Pose2, dubins: Dubins, fits: Fits) -> DubinsRoute:
    """The shortest path where that fits; else a tree (RRT) of such paths, grown until it reaches the goal or the
    iterations are used up, and what it found made shorter.

    Equal queries get equal routes. Not to be called from two threads at once, because OMPL keeps its seed in a global.
    """
    start_m = (query.start.x_m, query.start.y_m)
    direct = dubins.poses(query.start, goal)
    if fits(direct):
        points = (start_m, (goal.x_m, goal.y_m))
        return DubinsRoute(keys=(query.start, goal), tree_points_m=points, tree_parents=(0, 0), n_iterations=0)
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    # OMPL takes 0 for "choose one yourself".
    ou.RNG.setSeed(query.seed + 1)
    space = ob.DubinsStateSpace(query.min_turning_radius_m)
    bounds = ob.RealVectorBounds(2)
    grid = query.grid
    for axis, n_cells in ((0, grid.n_columns), (1, grid.n_rows)):
        bounds.setLow(axis, grid.origin_m[axis])
        bounds.setHigh(axis, grid.origin_m[axis] + n_cells * grid.resolution_m)
    space.setBounds(bounds)
    information = ob.SpaceInformation(space)
    information.setStateValidityChecker(ob.AllValidStateValidityChecker(information))
    information.setMotionValidator(_Fitting(information, dubins, fits))
    information.setup()
    begin, end = space.allocState(), space.allocState()
    set_state(begin, query.start)
    set_state(end, goal)
    problem = ob.ProblemDefinition(information)
    problem.setStartAndGoalStates(begin, end, _SAME_M)
    planner = og.RRT(information)
    planner.setRange(query.step_m)
    planner.setGoalBias(query.goal_bias)
    planner.setProblemDefinition(problem)
    planner.setup()
    budget = Budget(query.max_iterations)
    status = planner.solve(ob.PlannerTerminationCondition(budget)).getStatus()
    keys: tuple[Pose2, ...] = ()
    if status == ob.PlannerStatus.EXACT_SOLUTION:
        states = problem.getSolutionPath().getStates()
        keys = tuple(Pose2(x_m=s.getX(), y_m=s.getY(), yaw_rad=s.getYaw()) for s in states)
        keys = _shortened((*keys[:-1], goal), dubins, fits, query.seed)
    data = ob.PlannerData(information)
    planner.getPlannerData(data)
    nodes, parents = tree_of(data, lambda state: (state.getX(), state.getY()))
    return DubinsRoute(keys=keys, tree_points_m=tuple(nodes), tree_parents=tuple(parents), n_iterations=budget.n_used)


class _Fitting(ob.MotionValidator):  # type: ignore[misc]
    """Lets the tree grow along forward paths that fit all along."""

    def __init__(self, information: ob.SpaceInformation, dubins: Dubins, fits: Fits) -> None:
        super().__init__(information)
        self._dubins = dubins
        self._fits = fits

    def checkMotion(self, a: ob.State, b: ob.State) -> bool:  # noqa: N802 - OMPL's name
        return self._fits(self._dubins.sampled(a, b))


def _shortened(keys: tuple[Pose2, ...], dubins: Dubins, fits: Fits, seed: int) -> tuple[Pose2, ...]:
    """The path with detours cut off: two of its poses at a time are joined directly where that fits and is shorter.

    The rest of a shortest path is the shortest path from where it is cut, so keys describe the path again.
    """
    for i, j in _pairs_from_far(len(keys)):
        if j < len(keys) and _gains(keys[i : j + 1], dubins, fits):
            keys = (*keys[: i + 1], *keys[j:])
    random = np.random.default_rng(seed)
    for _ in range(N_SHORTCUTS):
        stretches = [dubins.poses(a, b) for a, b in pairwise(keys)]
        ends = np.cumsum([len(stretch) for stretch in stretches])
        poses = np.concatenate(stretches)
        low, high = sorted(random.integers(len(poses), size=2).tolist())
        of_low, of_high = (int(np.searchsorted(ends, index, side="right")) for index in (low, high))
        if of_low == of_high:
            continue
        a, b = (Pose2(x_m=x, y_m=y, yaw_rad=yaw) for x, y, yaw in poses[[low, high]].tolist())
        if _gains((a, *keys[of_low + 1 : of_high + 1], b), dubins, fits):
            keys = (*keys[: of_low + 1], a, b, *keys[of_high + 1 :])
    return keys


def _pairs_from_far(n: int) -> Iterator[tuple[int, int]]:
    """Places in a path, those that are farthest apart first."""
    for apart in range(n - 1, 1, -1):
        for i in range(n - apart):
            yield i, i + apart


def _gains(keys: tuple[Pose2, ...], dubins: Dubins, fits: Fits) -> bool:
    """Whether the direct path from the first to the last pose is shorter than over all of them, and fits."""
    present_m = sum(dubins.length_m(a, b) for a, b in pairwise(keys))
    if dubins.length_m(keys[0], keys[-1]) > present_m - LEAST_GAIN_M:
        return False
    return fits(dubins.poses(keys[0], keys[-1]))
