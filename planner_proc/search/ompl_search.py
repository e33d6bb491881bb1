"""Search for a path with OMPL."""

import weakref
from collections import deque
from collections.abc import Iterator
from math import hypot
from typing import Any, Final

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from legpush.geometry import Point2
from legpush.messages.common import MAX_WAYPOINTS
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
"""These make their path better; the others find another one."""
_TOWARD_A_POINT: Final[frozenset[PlannerName]] = frozenset({"rrt_connect", "bit_star"})
"""These have to sample the goal itself."""
_CURVED_STEP_M: Final = 2.0
"""Longest edge where curves are steered, at least: shorter ones cannot turn around."""
_FIRST_ITERATIONS: Final = 100
"""With `anytime`, a search that would go on improving stops after so many to see whether it has found a path."""
_SEEDS_APART: Final = 7919


def ompl_routes(query: TrunkPathQuery, field: ClearanceField, interrupted: Interrupted) -> Iterator[Route]:
    """Grow a tree from the start until it reaches the goal or the iterations are used up.

    `rrt` is Algorithm 1, `rrt_star` the same with rewiring until the budget ends, `informed_rrt_star` and `bit_star`
    look only where a better path can be, `rrt_connect` grows a second tree from the goal and joins the two. Not to be
    called from two threads at once, because OMPL keeps its seed in a global.
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
    """A planner of OMPL with its problem."""

    def __init__(self, query: TrunkPathQuery, field: ClearanceField, interrupted: Interrupted, seed: int) -> None:
        ou.setLogLevel(ou.LogLevel.LOG_NONE)
        # OMPL takes 0 for "choose one yourself".
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
        """Search on for so many iterations, or to the first path; `PlanningInterruptedError`."""
        budget = _Budget(n_iterations, self._interrupted)
        status = self._planner.solve(ob.PlannerTerminationCondition(budget)).getStatus()
        if budget.interrupted:
            raise PlanningInterruptedError
        self._n_iterations += budget.n_used
        # A status is true for an approximate solution as well, so it is compared by name.
        self.reached = status == ob.PlannerStatus.EXACT_SOLUTION

    def route(self) -> Route:
        """What has been found."""
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
    """Lets the tree grow along edges that keep the clearance at every point."""

    def __init__(self, information: ob.SpaceInformation, steer: Steer) -> None:
        super().__init__(information)
        # A BIT* that was asked for its tree is never freed, and this with it; the map must not be.
        self._steer = weakref.ref(steer)

    def checkMotion(self, a: ob.State, b: ob.State) -> bool:  # noqa: N802 - OMPL's name
        steer = self._steer()
        return steer is not None and steer.is_free(a, b)


class _GoalRegion(ob.GoalSampleableRegion):  # type: ignore[misc]
    """Satisfied by a node in the disc around the goal that sees the goal (Algorithm 1, line 14); samples the goal."""

    def __init__(self, information: ob.SpaceInformation, steer: Steer, goal: ob.State, radius_m: float) -> None:
        super().__init__(information)
        # OMPL compares with "less than", so a radius of 0 would shut out the goal itself.
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
    """Ends the search after so many iterations; OMPL asks once before each."""

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
    """Nodes and parents of what was grown, breadth first from the roots: parents come before their children."""
    n_nodes = data.numVertices()
    if data.numStartVertices() == 0:
        return [], []
    vertices = [data.getVertex(i) for i in range(n_nodes)]
    # The trees from the start and from the goal are told apart by a tag; the edge that joins them belongs to neither.
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
