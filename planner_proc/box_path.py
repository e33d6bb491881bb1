"""From a query for a path of the box to a plan: check it, search, measure. Pure: equal queries get equal plans."""

from itertools import pairwise
from math import hypot
from typing import Final

import numpy as np
from numpy.typing import NDArray

from legpush.geometry import Pose2
from legpush.messages import BoxPathQuery, Plan, Tree
from planner_proc.dubins import SAMPLE_M, Dubins, DubinsRoute, search
from planner_proc.footprint_field import FootprintField
from planner_proc.occupancy import ClearanceField

Floats = NDArray[np.float64]

EXTRA_CLEARANCE_M: Final = (0.0, 0.01, 0.03)
"""The search judges quickly; where what it found does not keep the clearance exactly, it is asked to keep more."""
NEAREST_STEP_M: Final = 0.05
NEAREST_REACH_M: Final = 2.0
"""How far around a pose that does not fit one that does is looked for, and how finely."""


def make_box_plan(query: BoxPathQuery, field: ClearanceField) -> Plan:
    """The plan for a query whose grid is sound; `field` is that of the grid."""
    footprints = FootprintField(query.grid, query.footprints, field)
    # Between two poses no point of the footprints moves farther than this from the nearer one.
    between_m = 0.5 * SAMPLE_M * (1.0 + footprints.reach_m / query.min_turning_radius_m)
    required_m = query.clearance_m + between_m
    for name, pose in (("start", query.start), ("goal", query.goal)):
        if not footprints.free(_row(pose), required_m)[0]:
            return Plan(status="invalid", reason=_no_room(name, pose, query, footprints, required_m))
    dubins = Dubins(query.min_turning_radius_m)
    before_goal = _run_in(query, dubins, footprints, required_m)
    for extra_m in EXTRA_CLEARANCE_M:
        route = search(query, before_goal, dubins, lambda poses: footprints.seems_free(poses, required_m + extra_m))
        if not route.keys:
            break
        keys = route.keys if before_goal == query.goal else (*route.keys, query.goal)
        path = dubins.path(keys)
        if footprints.free(path, required_m).all():
            return _found(route, keys, dubins, footprints, path)
    tree = Tree(points_m=route.tree_points_m, parents=route.tree_parents)
    reason = _shortfall(query, field, footprints, route.n_iterations)
    return Plan(status="failed", reason=reason, tree=tree, n_iterations=route.n_iterations)


def _found(
    route: DubinsRoute, keys: tuple[Pose2, ...], dubins: Dubins, footprints: FootprintField, path: Floats
) -> Plan:
    """A plan whose path was judged exactly."""
    length_m = sum(dubins.length_m(a, b) for a, b in pairwise(keys))
    return Plan(
        status="exact",
        reason=f"Reached after {route.n_iterations} iterations: {length_m:.2f} m",
        waypoints=tuple(Pose2(x_m=x, y_m=y, yaw_rad=yaw) for x, y, yaw in path.tolist()),
        raw_path_m=tuple((key.x_m, key.y_m) for key in keys),
        tree=Tree(points_m=route.tree_points_m, parents=route.tree_parents),
        length_m=length_m,
        min_clearance_m=footprints.clearance_m(path),
        n_iterations=route.n_iterations,
    )


def _run_in(query: BoxPathQuery, dubins: Dubins, footprints: FootprintField, required_m: float) -> Pose2:
    """Where the straight stretch before the goal begins: as long as asked for, or half of it, or none."""
    for run_in_m in (query.run_in_m, query.run_in_m / 2):
        begin = query.goal @ Pose2(x_m=-run_in_m, y_m=0.0, yaw_rad=0.0)
        if run_in_m > 0.0 and footprints.free(dubins.poses(begin, query.goal), required_m).all():
            return begin
    return query.goal


def _no_room(name: str, pose: Pose2, query: BoxPathQuery, footprints: FootprintField, required_m: float) -> str:
    """Why box and robot cannot be there, and where they could."""
    reason = (
        f"The box and the robot behind it do not fit at the {name} ({pose.x_m:g}, {pose.y_m:g}, "
        f"{np.degrees(pose.yaw_rad):.0f}°) with a clearance of {query.clearance_m:g} m"
    )
    n = round(NEAREST_REACH_M / NEAREST_STEP_M)
    steps = NEAREST_STEP_M * np.arange(-n, n + 1)
    around = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    around = around[np.argsort(np.hypot(*around.T), kind="stable")]
    poses = np.column_stack([around + pose.xy(), np.full(len(around), pose.yaw_rad)])
    for some in np.array_split(poses, 32):
        free = footprints.free(some, required_m)
        if free.any():
            x_m, y_m, _ = some[int(free.argmax())].tolist()
            return f"{reason}; they would {hypot(x_m - pose.x_m, y_m - pose.y_m):.2f} m away, at ({x_m:.2f}, {y_m:.2f})"
    return f"{reason}, nor within {NEAREST_REACH_M:g} m of it with this heading"


def _shortfall(query: BoxPathQuery, field: ClearanceField, footprints: FootprintField, n_iterations: int) -> str:
    """Why the goal was not reached."""
    start_m, goal_m = (query.start.x_m, query.start.y_m), (query.goal.x_m, query.goal.y_m)
    needed_m = footprints.narrowest_m + query.clearance_m
    if field.is_separated(start_m, goal_m, needed_m):
        return f"Obstacles cut off the goal: nowhere a passage of {2 * needed_m:.2f} m, which the box needs"
    size_m = [query.grid.n_columns * query.grid.resolution_m, query.grid.n_rows * query.grid.resolution_m]
    if 2 * query.min_turning_radius_m > min(size_m):
        return (
            f"A turning circle of {2 * query.min_turning_radius_m:.2f} m does not fit into {min(size_m):.2f} m, and "
            f"{n_iterations} iterations found no other way"
        )
    return (
        f"No way in {n_iterations} iterations: raise max_iterations, or lower min_turning_radius_m "
        f"({query.min_turning_radius_m:g} m) or clearance_m ({query.clearance_m:g} m)"
    )


def _row(pose: Pose2) -> Floats:
    return np.array([[pose.x_m, pose.y_m, pose.yaw_rad]])
