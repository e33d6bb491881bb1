"""Plans a path of the box: checks the query, searches, and measures exactly. Equal queries get equal plans."""

from dataclasses import replace
from itertools import pairwise
from math import degrees, hypot
from typing import Final

import numpy as np

from legpush.geometry import Pose2, wrap_angle
from legpush.messages.planning import BoxPathQuery, Plan, Tree
from legpush.plans.planner import Interrupted
from planner_proc.box.pushes import Pushes, Way
from planner_proc.box.search import Found, search
from planner_proc.clearance.field import ClearanceField

EXTRA_CLEARANCE_CELLS: Final = (0.0, 0.2, 0.6)
"""Extra clearances for the search, which measures quickly. The next one is tried if the path that was found does not
keep the clearance by the exact measure.
"""
MOST_WALKS: Final = 8
"""How many ways are searched whose walks around the box turn out to be too narrow for the body of the robot."""
SAME_PLACE_M: Final = 1e-9
"""A stage that is shorter than this is left out."""
NEAREST_STEP_M: Final = 0.05
"""Spacing of the places that are tried around a pose at which the box does not fit."""
NEAREST_REACH_M: Final = 2.0
"""How far around such a pose to try."""


def make_box_plan(query: BoxPathQuery, field: ClearanceField, interrupted: Interrupted = lambda: False) -> Plan:
    """Plan for a query with a valid grid; `field` is that of the grid.

    A query that cannot be met is no error: the plan's `status` and `reason` say so.

    Raises:
        PlanningInterruptedError: The plan is not wanted any more.
    """
    fault = _side_fault(query)
    if fault:
        return Plan(status="invalid", reason=fault)
    pushes = Pushes(query, field)
    fault = _pose_fault("start", query.start, query, pushes) or _pose_fault("goal", query.goal, query, pushes)
    if fault:
        return Plan(status="invalid", reason=fault)
    n_iterations = 0
    for extra_cells in EXTRA_CLEARANCE_CELLS:
        pushes.extra_m = extra_cells * query.grid.resolution_m
        found = search(query, pushes, interrupted)
        n_iterations += found.n_iterations
        for _ in range(MOST_WALKS):
            if not found.way or pushes.body_can_walk(found.way):
                break
            found = search(query, pushes, interrupted)
            n_iterations += found.n_iterations
        else:
            found = replace(found, way=())
        if not found.way:
            break
        plan = _judged(found, pushes, n_iterations)
        if plan is not None:
            return plan
    tree = Tree(points_m=found.tree_points_m, parents=found.tree_parents)
    reason = _shortfall(query, field, pushes, n_iterations)
    return Plan(status="failed", reason=reason, tree=tree, n_iterations=n_iterations)


def _side_fault(query: BoxPathQuery) -> str:
    """Why `present_side` is invalid; empty if it is not."""
    if query.present_side is not None and query.present_side >= len(query.sides):
        return f"Expected present_side below {len(query.sides)}, the number of sides, got {query.present_side}"
    return ""


def _pose_fault(name: str, pose: Pose2, query: BoxPathQuery, pushes: Pushes) -> str:
    """Why the box cannot be pushed from the start, or to the goal, and the nearest place where it can; or empty."""
    if _works(name, pose, query, pushes):
        return ""
    doing = "be pushed away from" if name == "start" else "be pushed to"
    reason = (
        f"The box cannot {doing} the {name} ({pose.x_m:g}, {pose.y_m:g}, {degrees(pose.yaw_rad):.0f}°): box and robot "
        f"do not fit there with a clearance of {query.clearance_m:g} m, whichever face is pushed"
    )
    n = round(NEAREST_REACH_M / NEAREST_STEP_M)
    steps = (NEAREST_STEP_M * np.arange(-n, n + 1)).tolist()
    for x_m, y_m in sorted(((x, y) for x in steps for y in steps), key=lambda offset: hypot(*offset)):
        near = Pose2(x_m=pose.x_m + x_m, y_m=pose.y_m + y_m, yaw_rad=pose.yaw_rad)
        if _works(name, near, query, pushes):
            return f"{reason}; the nearest place with this heading is {hypot(x_m, y_m):.2f} m away, at " + (
                f"({near.x_m:.2f}, {near.y_m:.2f})"
            )
    return f"{reason}, nor within {NEAREST_REACH_M:g} m of it with this heading"


def _works(name: str, pose: Pose2, query: BoxPathQuery, pushes: Pushes) -> bool:
    """Whether the box can be pushed at a pose from any side.

    At the goal, and at the side where the robot stands already, box and robot only have to fit. At another side, the
    robot also needs room to come there.
    """
    for index, side in enumerate(pushes.sides):
        standing = name == "goal" or index == query.present_side
        if side.fits(pose) if standing else side.can_begin(pose):
            return True
    return False


def _judged(found: Found, pushes: Pushes, n_iterations: int) -> Plan | None:
    """Make a plan of the way that was found; None if box or robot do not keep the clearance by the exact measure."""
    waypoints: list[Pose2] = []
    sides: list[int] = []
    clearance_m = np.inf
    way = tuple(stage for stage in found.way if stage.length_m > SAME_PLACE_M) or found.way[:1]
    for stage in way:
        side = pushes.sides[stage.side]
        pushed = side.pushed(stage)
        if not side.footprints.free(pushed, side.required_m).all():
            return None
        clearance_m = min(clearance_m, side.footprints.clearance_m(pushed))
        poses = side.box(pushed)[1 if waypoints and sides[-1] == stage.side else 0 :].tolist()
        waypoints += [Pose2(x_m=x_m, y_m=y_m, yaw_rad=wrap_angle(yaw_rad)) for x_m, y_m, yaw_rad in poses]
        sides += [stage.side] * len(poses)
    length_m = sum(stage.length_m for stage in way)
    n_stages = 1 + sum(a.side != b.side for a, b in pairwise(way))
    return Plan(
        status="exact",
        reason=f"Reached after {n_iterations} iterations: {length_m:.2f} m in {n_stages} stages",
        waypoints=tuple(waypoints),
        sides=tuple(sides),
        raw_path_m=_corners(way),
        tree=Tree(points_m=found.tree_points_m, parents=found.tree_parents),
        length_m=length_m,
        min_clearance_m=float(clearance_m),
        n_iterations=n_iterations,
    )


def _corners(way: Way) -> tuple[tuple[float, float], ...]:
    """Positions at which the stages begin, and the one at which the last stage ends."""
    return tuple((pose.x_m, pose.y_m) for pose in (*(stage.begin for stage in way), way[-1].end))


def _shortfall(query: BoxPathQuery, field: ClearanceField, pushes: Pushes, n_iterations: int) -> str:
    """Why the goal was not reached."""
    start_m, goal_m = (query.start.x_m, query.start.y_m), (query.goal.x_m, query.goal.y_m)
    needed_m = min(side.footprints.narrowest_m for side in pushes.sides) + query.clearance_m
    if field.is_separated(start_m, goal_m, needed_m):
        return f"Obstacles cut off the goal: nowhere a passage of {2 * needed_m:.2f} m, which the box needs"
    radius_m = min(side.min_turning_radius_m for side in query.sides)
    size_m = min(query.grid.n_columns, query.grid.n_rows) * query.grid.resolution_m
    walks = (
        "; box and robot fit on some ways where the robot cannot come to the side to push: its walk needs a passage of "
        f"{2 * query.walk_clearance_m:.2f} m"
    )
    narrow = f"; a turning circle of {2 * radius_m:.2f} m does not fit into a room of {size_m:.2f} m"
    return (
        f"No way in {n_iterations} iterations: raise `pushing.max_iterations`, or lower `pushing.margin_m` (the "
        f"clearance is {query.clearance_m:g} m) or `pushing.turning_reserve` (the turning radius is {radius_m:g} m)"
        + (walks if pushes.out_of_reach else "")
        + (narrow if 2 * radius_m > size_m else "")
    )
