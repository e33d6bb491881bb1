"""Searches a route for the trunk with the planners of OMPL."""

import weakref
from collections import deque
from collections.abc import Iterator
from math import hypot
from typing import Any, Final

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from legpush.bounds import MAX_WAYPOINTS
from legpush.geometry import Point2
from legpush.messages.planning import TrunkPathQuery
from legpush.plans.planner import Interrupted, PlanningInterruptedError
from legpush.scene.names import PlannerName
from planner_proc.clearance.field import ClearanceField
from planner_proc.search.route import Route
from planner_proc.search.steering import Curved, Steer, Straight
from planner_proc.search_tree import thin

_PLANNERS: Final[dict[PlannerName, type]] = {
    "rrt": og.RRT,
    "rrt_connect": og.RRTConnect,
    "rrt_star": og.RRTstar,
    "informed_rrt_star": og.InformedRRTstar,
    "bit_star": og.BITstar,
}
_GROWS_ON: Final[frozenset[PlannerName]] = frozenset({"rrt_star", "informed_rrt_star", "bit_star"})
"""Planners that improve their path when they run on. The others have to start another search."""
_TOWARD_A_POINT: Final[frozenset[PlannerName]] = frozenset({"rrt_connect", "bit_star"})
"""Planners that sample the goal itself and cannot aim at a region."""
_CURVED_STEP_M: Final = 2.0
"""Least value of the longest edge if curves are steered: shorter edges cannot turn around."""
_FIRST_ITERATIONS: Final = 100
"""With `anytime`, how many iterations a planner that improves its path runs before each look for a first one."""
_SEEDS_APART: Final = 7919
"""Difference between the seeds of one search and the next, for planners that do not improve their path."""


def ompl_routes(query: TrunkPathQuery, field: ClearanceField, interrupted: Interrupted) -> Iterator[Route]:
    """Grow a tree from the start until it reaches the goal or the iterations are used up.

    `rrt` is Algorithm 1. `rrt_star` adds rewiring, and uses all its iterations. `informed_rrt_star` and `bit_star`
    sample only where a better path can be. `rrt_connect` grows a second tree from the goal and joins the two. Do not
    call this from two threads at once: OMPL keeps its seed in a global variable.

    Raises:
        PlanningInterruptedError: The routes are not wanted any more.
    """
    search = _Search(query, field, interrupted, query.seed)
    anytime = query.anytime
    if anytime is None:
        search.run(query.max_iterations)
        yield search.route()
        return
    grows_on = query.planner in _GROWS_ON
    n = 0
    while not search.reached and n < query.max_iterations:
        more = min(_FIRST_ITERATIONS if grows_on else query.max_iterations, query.max_iterations - n)
        search.run(more)
        n += more
    yield search.route()
    for k in range(1, anytime.n_improvements + 1):
        if not grows_on:
            search = _Search(query, field, interrupted, query.seed + k * _SEEDS_APART)
        search.run(anytime.improvement_iterations)
        yield search.route()


class _Search:
    """A planner of OMPL, set up for a query."""

    def __init__(self, query: TrunkPathQuery, field: ClearanceField, interrupted: Interrupted, seed: int) -> None:
        ou.setLogLevel(ou.LogLevel.LOG_NONE)
        # OMPL draws a seed of its own if it gets 0.
        ou.RNG.setSeed(seed % 2**32 + 1)
        self._query = query
        self._interrupted = interrupted
        self._steer: Steer = Straight(query, field) if query.steering == "straight" else Curved(query, field)
        self._information = ob.SpaceInformation(self._steer.space)
        self._information.setStateValidityChecker(ob.AllValidStateValidityChecker(self._information))
        self._information.setMotionValidator(_Clearance(self._information, self._steer))
        self._information.setup()
        self._problem = ob.ProblemDefinition(self._information)
        self._problem.addStartState(self._steer.state(query.start))
        region_m = 0.0 if query.planner in _TOWARD_A_POINT else query.goal_region_m
        self._goal = self._steer.state(query.goal)
        self._problem.setGoal(_GoalRegion(self._information, self._steer, self._goal, region_m))
        self._planner = _PLANNERS[query.planner](self._information)
        if query.planner != "bit_star":
            step_m = query.step_m if query.steering == "straight" else max(query.step_m, _CURVED_STEP_M)
            self._planner.setRange(step_m)
        if query.planner not in _TOWARD_A_POINT:
            self._planner.setGoalBias(query.goal_bias)
        self._planner.setProblemDefinition(self._problem)
        self._planner.setup()
        self._n_iterations = 0
        self.reached = False

    def run(self, n_iterations: int) -> None:
        """Search on for `n_iterations`, or until there is a path if the planner stops at its first one.

        Raises:
            PlanningInterruptedError: The routes are not wanted any more.
        """
        budget = _Budget(n_iterations, self._interrupted)
        status = self._planner.solve(ob.PlannerTerminationCondition(budget)).getStatus()
        if budget.interrupted:
            raise PlanningInterruptedError
        self._n_iterations += budget.n_used
        # A status is also true for an approximate solution, so it is compared with the exact one.
        self.reached = status == ob.PlannerStatus.EXACT_SOLUTION

    def route(self) -> Route:
        """The best route that has been found, or the one that ends nearest to the goal."""
        steer, start, goal = self._steer, self._query.start, (self._query.goal.x_m, self._query.goal.y_m)
        states: list[Any] = [steer.state(start)]
        if self._problem.hasSolution():
            states = list(self._problem.getSolutionPath().getStates())
        data = ob.PlannerData(self._information)
        self._planner.getPlannerData(data)
        nodes, parents = _tree(data, steer, two_trees=self._query.planner == "rrt_connect")
        if self.reached and steer.place(states[-1]) != goal:
            parents.append(nodes.index(steer.place(states[-1])))
            nodes.append(goal)
        if self.reached and not self._information.equalStates(states[-1], self._goal):
            states.append(self._goal)
        nodes, parents = thin(nodes, parents, MAX_WAYPOINTS)
        return Route(
            reached=self.reached,
            points_m=np.array([steer.place(state) for state in states], dtype=np.float64),
            curve=steer.curve(states),
            tree_points_m=tuple(nodes),
            tree_parents=tuple(parents),
            n_iterations=self._n_iterations,
        )


class _Clearance(ob.MotionValidator):  # type: ignore[misc]
    """Accepts edges that keep the clearance at every point."""

    def __init__(self, information: ob.SpaceInformation, steer: Steer) -> None:
        super().__init__(information)
        # OMPL never frees a BIT* that was asked for its tree, nor this validator. The map must be freed.
        self._steer = weakref.ref(steer)

    def checkMotion(self, a: ob.State, b: ob.State) -> bool:  # noqa: N802 - OMPL's name
        steer = self._steer()
        return steer is not None and steer.is_free(a, b)


class _GoalRegion(ob.GoalSampleableRegion):  # type: ignore[misc]
    """A disc around the goal, satisfied by a node from which the goal can be reached straight (Algorithm 1, line 14).

    Its one sample is the goal.
    """

    def __init__(self, information: ob.SpaceInformation, steer: Steer, goal: ob.State, radius_m: float) -> None:
        super().__init__(information)
        # OMPL compares with "less than", so a radius of 0 would exclude the goal itself.
        self._radius_m = max(radius_m, 1e-9)
        self.setThreshold(self._radius_m)
        self._space = steer.space
        self._steer = steer
        self._goal = goal
        self._goal_m = steer.place(goal)

    def distanceGoal(self, state: ob.State) -> float:  # noqa: N802 - OMPL's name
        x_m, y_m = self._steer.place(state)
        distance_m = hypot(x_m - self._goal_m[0], y_m - self._goal_m[1])
        if distance_m < self._radius_m and not self._steer.is_free(state, self._goal):
            return self._radius_m
        return distance_m

    def sampleGoal(self, state: ob.State) -> None:  # noqa: N802 - OMPL's name
        self._space.copyState(state, self._goal)

    def maxSampleCount(self) -> int:  # noqa: N802 - OMPL's name
        return 1


class _Budget:
    """Ends a search after `n_allowed` iterations, or when it is interrupted; OMPL asks once before each iteration."""

    def __init__(self, n_allowed: int, interrupted: Interrupted) -> None:
        self._n_allowed = n_allowed
        self._interrupted = interrupted
        self.n_used = 0
        self.interrupted = False

    def __call__(self) -> bool:
        if self.n_used >= self._n_allowed or self.interrupted:
            return True
        self.n_used += 1
        self.interrupted = self._interrupted()
        return self.interrupted


def _tree(data: ob.PlannerData, steer: Steer, *, two_trees: bool) -> tuple[list[Point2], list[int]]:
    """Nodes and parents of the trees, breadth first from the roots, so that parents come before their children."""
    n_nodes = data.numVertices()
    if data.numStartVertices() == 0:
        return [], []
    vertices = [data.getVertex(i) for i in range(n_nodes)]
    # A tag distinguishes the trees from the start and from the goal; the edge that joins them belongs to neither.
    tags = [vertex.getTag() if two_trees else 0 for vertex in vertices]
    neighbours: list[list[int]] = [[] for _ in range(n_nodes)]
    for i in range(n_nodes):
        for j in data.getEdges(i):
            if tags[i] == tags[j]:
                neighbours[i].append(j)
                neighbours[j].append(i)
    roots = [data.getStartIndex(0)]
    roots += [i for i in map(data.getGoalIndex, range(data.numGoalVertices())) if tags[i] != tags[roots[0]]]
    place = {root: order for order, root in enumerate(roots)}
    parents = list(range(len(roots)))
    waiting = deque(roots)
    while waiting:
        node = waiting.popleft()
        for child in neighbours[node]:
            if child not in place:
                place[child] = len(place)
                parents.append(place[node])
                waiting.append(child)
    return [steer.place(vertices[i].getState()) for i in place], parents
