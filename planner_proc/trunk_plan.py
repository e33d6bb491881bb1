"""Plans a path of the trunk: searches a route, shortens, smooths and measures it. Equal queries get equal plans."""

from collections.abc import Iterator
from math import hypot
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.bounds import MAX_WAYPOINTS
from legpush.geometry import Point2, Pose2, wrap_angle
from legpush.messages.planning import Plan, Tree, TrunkPathQuery
from legpush.plans.planner import Interrupted
from planner_proc.body.fitting import BodyFitting
from planner_proc.clearance.field import ROUNDING_M, ClearanceField
from planner_proc.search.registry import routes
from planner_proc.search.route import Route
from planner_proc.smoothing import polylines
from planner_proc.smoothing.shortcut import shortcut
from planner_proc.smoothing.spline import smooth
from planner_proc.smoothing.tube import Tube

SAME_PLACE_M: Final = 1e-6
"""Two positions that are nearer than this count as one."""


def make_trunk_plans(query: TrunkPathQuery, field: ClearanceField, interrupted: Interrupted) -> Iterator[Plan]:
    """Yield a plan for a query with a valid grid, then, with `anytime`, the best plan after each improvement.

    `field` is that of the grid. A query that cannot be met is no error: the plan's `status` and `reason` say so.

    Raises:
        PlanningInterruptedError: The plans are not wanted any more.
    """
    for name, pose in (("start", query.start), ("goal", query.goal)):
        fault = _pose_fault(name, pose, field, query)
        if fault:
            yield Plan(status="invalid", reason=fault)
            return
    n_revisions = 1 + (query.anytime.n_improvements if query.anytime is not None else 0)
    there = _distance_m(query.start, (query.goal.x_m, query.goal.y_m)) < SAME_PLACE_M
    if there and (query.steering == "straight" or wrap_angle(query.goal.yaw_rad - query.start.yaw_rad) == 0.0):
        yield from [_turn_on_the_spot(query, field)] * n_revisions
        return
    best: Plan | None = None
    fitting = BodyFitting(query, field) if query.body is not None else None
    for route in routes(query, field, interrupted):
        plan = _plan_from_route(query, field, route)
        if fitting is not None and plan.status == "exact":
            plan = fitting.fitted(plan)
        if best is None or _is_better(plan, best):
            best = plan
        yield best


def _pose_fault(name: str, pose: Pose2, field: ClearanceField, query: TrunkPathQuery) -> str:
    """Why the robot cannot stand at a pose; empty if it can."""
    place = f"The {name} ({pose.x_m:g}, {pose.y_m:g})"
    if not field.contains(pose.x_m, pose.y_m):
        return f"{place} lies off the map, which spans {query.grid.extent()}"
    point_m = np.array([[pose.x_m, pose.y_m]])
    if field.bounds_m(point_m, query.clearance_m)[0] >= query.clearance_m:
        return ""
    clearance_m = float(field.clearance_m(point_m)[0])
    if clearance_m == 0.0:
        return f"{place} lies in an obstacle; a clearance of {query.clearance_m:g} m is required"
    if not clearance_m >= query.clearance_m - ROUNDING_M:
        return f"{place} has a clearance of {clearance_m:.6g} m; {query.clearance_m:g} m is required"
    return ""


def _turn_on_the_spot(query: TrunkPathQuery, field: ClearanceField) -> Plan:
    """The plan for a goal at the start."""
    start_m = (query.start.x_m, query.start.y_m)
    return Plan(
        status="exact",
        reason="The goal is at the start: turn on the spot",
        waypoints=(query.start, query.goal),
        raw_path_m=(start_m, (query.goal.x_m, query.goal.y_m)),
        tree=Tree(points_m=(start_m,), parents=(0,)),
        min_clearance_m=float(field.clearance_m(np.array([start_m]))[0]),
    )


def _plan_from_route(query: TrunkPathQuery, field: ClearanceField, route: Route) -> Plan:
    """Shorten, smooth and measure the route that the search found."""
    tree = Tree(points_m=route.tree_points_m, parents=route.tree_parents)

    def failed(reason: str) -> Plan:
        return Plan(status="failed", reason=reason, tree=tree, n_iterations=route.n_iterations)

    if len(route.points_m) < 2:
        return failed(_shortfall(query, field, route))
    if len(route.points_m) > MAX_WAYPOINTS:
        return failed(
            f"The search took {len(route.points_m)} steps to the goal, a plan holds {MAX_WAYPOINTS}: "
            f"raise step_m, which is {query.step_m:g} m"
        )
    goal = query.goal if route.reached else None
    if route.curve is not None:
        path_m = route.curve[:, :2]
        waypoints = _poses(route.curve, query.start, goal)
        if not field.free_segments(path_m, query.clearance_m).all():
            return failed("The curve that was found keeps the clearance only nearly; lower clearance_m a little")
    else:
        stretches = _smoothed(query, field, route.points_m)
        if not stretches:
            return failed(
                f"The way that was found cannot be smoothed to a turning radius of {query.min_turning_radius_m:g} m: "
                "lower it, raise clearance, or steer by dubins or reeds_shepp"
            )
        path_m = np.concatenate(stretches)
        waypoints = _waypoints(stretches, query.start, goal)
    if len(waypoints) > (n_most := query.smoothing.max_waypoints):
        return failed(f"The path has {len(waypoints)} waypoints: raise max_waypoints, which is {n_most}")
    length_m = polylines.length(path_m)
    reached = f"Reached after {route.n_iterations} iterations: {length_m:.2f} m"
    return Plan(
        status="exact" if route.reached else "approximate",
        reason=reached if route.reached else _shortfall(query, field, route),
        waypoints=waypoints,
        raw_path_m=tuple((x_m, y_m) for x_m, y_m in route.points_m.tolist()),
        tree=tree,
        length_m=length_m,
        min_clearance_m=field.path_clearance_m(path_m),
        n_iterations=route.n_iterations,
    )


def _smoothed(query: TrunkPathQuery, field: ClearanceField, points_m: Floats) -> list[Floats]:
    """Stretches of a smooth path; empty if none keeps the turning radius."""
    options = query.smoothing
    tube = Tube(field, query.clearance_m, points_m, options.max_deviation_m)
    corners_m = shortcut(points_m, tube) if options.shorten else _distinct(points_m)
    return smooth(corners_m, tube, options, query.min_turning_radius_m)


def _distinct(points_m: Floats) -> Floats:
    """The points, (n, 2), without those that repeat the one before, (k, 2)."""
    moves = np.hypot(*np.diff(points_m, axis=0).T) > 0.0
    distinct: Floats = points_m[np.concatenate([[True], moves])]
    return distinct


def _poses(curve: Floats, start: Pose2, goal: Pose2 | None) -> tuple[Pose2, ...]:
    """A curve, (n, 3), as waypoints; the start, and the goal if it was reached, are exactly those of the query."""
    inner = [Pose2(x_m=x_m, y_m=y_m, yaw_rad=wrap_angle(yaw_rad)) for x_m, y_m, yaw_rad in curve[1:].tolist()]
    return (start, *inner[:-1], goal) if goal else (start, *inner)


def _waypoints(stretches: list[Floats], start: Pose2, goal: Pose2 | None) -> tuple[Pose2, ...]:
    """Waypoints along stretches, with headings along them, between the start and, if it was reached, the goal."""
    waypoints = [start]
    for stretch in stretches:
        for (x_m, y_m), heading_rad in zip(stretch.tolist(), polylines.headings(stretch).tolist(), strict=True):
            waypoints.append(Pose2(x_m=x_m, y_m=y_m, yaw_rad=wrap_angle(heading_rad)))
    return (*waypoints, goal) if goal else tuple(waypoints)


def _shortfall(query: TrunkPathQuery, field: ClearanceField, route: Route) -> str:
    """Why the goal was not reached, and how far from it the path ends."""
    x_m, y_m = route.points_m[-1].tolist()
    missing = f"{_distance_m(query.goal, (x_m, y_m)):.2f} m from the goal after {route.n_iterations} iterations"
    start_m, goal_m = (query.start.x_m, query.start.y_m), (query.goal.x_m, query.goal.y_m)
    if field.is_separated(start_m, goal_m, query.clearance_m):
        return f"No path keeps a clearance of {query.clearance_m:g} m: obstacles cut off the goal; ended {missing}"
    return (
        f"Ended {missing}: raise `planning.max_iterations`, or lower `planning.margin_m` (the clearance is "
        f"{query.clearance_m:g} m)"
    )


def _is_better(plan: Plan, other: Plan) -> bool:
    """Whether a plan is exact and the other is not, or both are and it is shorter."""
    if (plan.status == "exact") != (other.status == "exact"):
        return plan.status == "exact"
    return plan.status == "exact" and plan.length_m < other.length_m


def _distance_m(pose: Pose2, point_m: Point2) -> float:
    return hypot(pose.x_m - point_m[0], pose.y_m - point_m[1])
