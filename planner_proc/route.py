"""Search for a path with OMPL: the only module that imports it."""

from collections import deque
from dataclasses import dataclass
from math import hypot
from typing import Final

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from legpush.messages import MAX_WAYPOINTS, Point2, TrunkPathQuery
from legpush.scenario import PlannerName
from planner_proc.occupancy import ClearanceField
from planner_proc.search_tree import thin

_PLANNERS: Final[dict[PlannerName, type]] = {"rrt": og.RRT, "rrt_connect": og.RRTConnect, "rrt_star": og.RRTstar}


@dataclass(frozen=True, kw_only=True)
class Route:
    """What the search found: a path from the start, the tree it grew, and whether the path ends at the goal."""

    reached: bool
    points_m: NDArray[np.float64]
    """(n, 2), the start first; the start alone where nothing else was found."""
    tree_points_m: tuple[Point2, ...]
    tree_parents: tuple[int, ...]
    """Node i hangs on node `tree_parents[i]`, a root on itself; parents come before their children."""
    n_iterations: int


def search(query: TrunkPathQuery, field: ClearanceField) -> Route:
    """Grow a tree from the start until it reaches the goal or the iterations are used up.

    `rrt` is Algorithm 1, `rrt_star` the same with rewiring until the budget ends, `rrt_connect` grows a second tree
    from the goal and joins the two. The same query always gives the same route: every random number comes from its
    seed. Not to be called from two threads at once, because OMPL keeps that seed in a global.
    """
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    # OMPL takes 0 for "choose one yourself".
    ou.RNG.setSeed(query.seed + 1)
    start, goal = (query.start.x_m, query.start.y_m), (query.goal.x_m, query.goal.y_m)
    space = _space(query, field)
    information = ob.SpaceInformation(space)
    information.setStateValidityChecker(ob.AllValidStateValidityChecker(information))
    information.setMotionValidator(_Clearance(information, field, query.clearance_m))
    information.setup()

    problem = ob.ProblemDefinition(information)
    state = space.allocState()
    state[0], state[1] = start
    problem.addStartState(state)
    region_m = 0.0 if query.planner == "rrt_connect" else query.goal_region_m
    problem.setGoal(_GoalRegion(information, field, goal, region_m, query.clearance_m))

    planner = _PLANNERS[query.planner](information)
    planner.setRange(query.step_m)
    if query.planner != "rrt_connect":
        planner.setGoalBias(query.goal_bias)
    planner.setProblemDefinition(problem)
    planner.setup()
    budget = _Budget(query.max_iterations)
    status = planner.solve(ob.PlannerTerminationCondition(budget)).getStatus()

    # A status is true for an approximate solution as well, so it is compared by name.
    reached = status == ob.PlannerStatus.EXACT_SOLUTION
    points = [start]
    if problem.hasSolution():
        points = [(state[0], state[1]) for state in problem.getSolutionPath().getStates()]
    data = ob.PlannerData(information)
    planner.getPlannerData(data)
    nodes, parents = _tree(data)
    if reached and points[-1] != goal:
        parents.append(nodes.index(points[-1]))
        nodes.append(goal)
        points.append(goal)
    nodes, parents = thin(nodes, parents, MAX_WAYPOINTS)
    return Route(
        reached=reached,
        points_m=np.array(points, dtype=np.float64),
        tree_points_m=tuple(nodes),
        tree_parents=tuple(parents),
        n_iterations=budget.n_used,
    )


class _Clearance(ob.MotionValidator):  # type: ignore[misc]
    """Lets the tree grow along edges that keep the clearance at every point."""

    def __init__(self, information: ob.SpaceInformation, field: ClearanceField, clearance_m: float) -> None:
        super().__init__(information)
        self._segment_is_free = field.segment_is_free
        self._clearance_m = clearance_m

    def checkMotion(self, a: ob.State, b: ob.State) -> bool:  # noqa: N802 - OMPL's name
        return self._segment_is_free((a[0], a[1]), (b[0], b[1]), self._clearance_m)


class _GoalRegion(ob.GoalSampleableRegion):  # type: ignore[misc]
    """Satisfied by a node in the disc around the goal that sees the goal (Algorithm 1, line 14); samples the goal."""

    def __init__(
        self,
        information: ob.SpaceInformation,
        field: ClearanceField,
        goal_m: Point2,
        radius_m: float,
        clearance_m: float,
    ) -> None:
        super().__init__(information)
        # OMPL compares with "less than", so a radius of 0 would shut out the goal itself.
        self._radius_m = max(radius_m, 1e-9)
        self.setThreshold(self._radius_m)
        self._segment_is_free = field.segment_is_free
        self._goal_m = goal_m
        self._clearance_m = clearance_m

    def distanceGoal(self, state: ob.State) -> float:  # noqa: N802 - OMPL's name
        x_m, y_m = state[0], state[1]
        distance_m = hypot(x_m - self._goal_m[0], y_m - self._goal_m[1])
        if distance_m < self._radius_m and not self._segment_is_free((x_m, y_m), self._goal_m, self._clearance_m):
            return self._radius_m
        return distance_m

    def sampleGoal(self, state: ob.State) -> None:  # noqa: N802 - OMPL's name
        state[0], state[1] = self._goal_m

    def maxSampleCount(self) -> int:  # noqa: N802 - OMPL's name
        return 1


class _Budget:
    """Ends the search after so many iterations; OMPL asks once before each."""

    def __init__(self, n_allowed: int) -> None:
        self._n_allowed = n_allowed
        self.n_used = 0

    def __call__(self) -> bool:
        if self.n_used >= self._n_allowed:
            return True
        self.n_used += 1
        return False


def _space(query: TrunkPathQuery, field: ClearanceField) -> ob.RealVectorStateSpace:
    """The plane, as far as the grid reaches."""
    space = ob.RealVectorStateSpace(2)
    bounds = ob.RealVectorBounds(2)
    for axis, (low_m, size_m) in enumerate(zip(query.grid.origin_m, field.size_m, strict=True)):
        bounds.setLow(axis, low_m)
        bounds.setHigh(axis, low_m + size_m)
    space.setBounds(bounds)
    return space


def _tree(data: ob.PlannerData) -> tuple[list[Point2], list[int]]:
    """Nodes and parents of what was grown, breadth first from the roots: parents come before their children."""
    n_nodes = data.numVertices()
    vertices = [data.getVertex(i) for i in range(n_nodes)]
    # The trees from the start and from the goal are told apart by a tag; the edge that joins them belongs to neither.
    tags = [vertex.getTag() for vertex in vertices]
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
    states = [vertices[i].getState() for i in place]
    return [(state[0], state[1]) for state in states], parents
