"""Faults of a path of the box: ends, sides, motion, and the exact distance of box and robot to occupied cells."""

from collections.abc import Iterator
from itertools import pairwise
from math import hypot, inf, pi
from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.planning import BoxPathQuery, Plan, PushSide
from legpush.scene.clearance import Nearest, clearance
from planner_proc.conformance.truth import LONGEST_STEP_M, RADIUS_SHARE, SAME_M, SAME_RAD

NO_TURN_M: Final = 1e-3
"""A step that is shorter than this, or less to the side, says nothing about how the box moves."""


def box_faults(query: BoxPathQuery, plan: Plan) -> list[str]:
    """Everything in an `exact` plan that contradicts the protocol; empty for an honest plan."""
    n_waypoints, n_sides = len(plan.waypoints), len(plan.sides)
    n_least = 1 if _is_at_goal(query) else 2
    if n_waypoints < n_least or n_sides != n_waypoints:
        least = "one" if n_least == 1 else "two"
        return [f"it has {n_waypoints} waypoints and {n_sides} sides, expected equally many, and at least {least}"]
    if max(plan.sides) >= len(query.sides):
        return [f"it pushes side {max(plan.sides)}, expected one below {len(query.sides)}"]
    found = [
        *_end_faults("begins", plan.waypoints[0], query.start, SAME_M, SAME_RAD),
        *_end_faults("ends", plan.waypoints[-1], query.goal, query.position_tolerance_m, query.angle_tolerance_rad),
    ]
    found += list(dict.fromkeys(_motion_faults(query, plan)))[:3]
    nearest = _clearance(query, plan)
    if nearest.distance_m < query.clearance_m - SAME_M:
        x_m, y_m = nearest.at_m
        found.append(
            f"it collides: near ({x_m:.2f}, {y_m:.2f}) box or robot is {nearest.distance_m:.3f} m from something "
            f"occupied, {query.clearance_m:g} m were asked for"
        )
    return found


def _is_at_goal(query: BoxPathQuery) -> bool:
    """Whether the box begins within the tolerances of its goal, so that its path need not move it."""
    off = query.goal.inverse() @ query.start
    return (
        hypot(off.x_m, off.y_m) <= query.position_tolerance_m
        and abs(wrap_angle(off.yaw_rad)) <= query.angle_tolerance_rad
    )


def _end_faults(verb: str, got: Pose2, expected: Pose2, within_m: float, within_rad: float) -> list[str]:
    """Where an end of the path misses the pose that is expected, beyond its tolerances."""
    off_m = hypot(got.x_m - expected.x_m, got.y_m - expected.y_m)
    off_rad = abs(wrap_angle(got.yaw_rad - expected.yaw_rad))
    found = []
    if off_m > within_m + SAME_M:
        found.append(
            f"the box {verb} at ({got.x_m:g}, {got.y_m:g}), {off_m:.3g} m from ({expected.x_m:g}, {expected.y_m:g})"
        )
    if off_rad > within_rad + SAME_RAD:
        hint = "; are these degrees?" if abs(got.yaw_rad) > 2 * pi else ""
        found.append(f"the box {verb} with a heading of {got.yaw_rad:g} rad, expected {expected.yaw_rad:g}{hint}")
    return found


def _motion_faults(query: BoxPathQuery, plan: Plan) -> Iterator[str]:
    """Where the pushed frame moves in a way that no push can move it."""
    for (a, side_a), (b, side_b) in pairwise(zip(plan.waypoints, plan.sides, strict=True)):
        side = query.sides[side_b]
        moved = (a @ side.frame).inverse() @ (b @ side.frame)
        step_m, turn_rad = hypot(moved.x_m, moved.y_m), abs(wrap_angle(moved.yaw_rad))
        if side_a != side_b and step_m > SAME_M:
            yield "the box moves while the robot changes sides"
        elif step_m > LONGEST_STEP_M:
            yield f"waypoints are farther than {LONGEST_STEP_M:g} m apart"
        elif moved.x_m < -NO_TURN_M:
            yield f"side {side_b} is pulled: the box moves backward"
        elif abs(moved.y_m) > step_m**2 / side.min_turning_radius_m + NO_TURN_M:
            yield f"the box slips sideways, as seen from the frame of side {side_b}"
        elif turn_rad > (1.0 + RADIUS_SHARE) * (step_m + SAME_M) / side.min_turning_radius_m:
            yield f"it turns on a radius below the {side.min_turning_radius_m:g} m of side {side_b}"


def _clearance(query: BoxPathQuery, plan: Plan) -> Nearest:
    """Least clearance of the outlines of all footprints at all waypoints."""
    best = Nearest(distance_m=inf, at_m=(0.0, 0.0))
    for waypoint, index in zip(plan.waypoints, plan.sides, strict=True):
        for corners in _outlines(waypoint, query.sides[index]):
            nearest = clearance(query.grid, corners)
            best = nearest if nearest.distance_m < best.distance_m else best
    return best


def _outlines(box: Pose2, side: PushSide) -> Iterator[Floats]:
    """The corners of each footprint, with the first one repeated at the end, (5, 2)."""
    for footprint in side.footprints:
        corners = replace(footprint, pose=box @ side.frame @ footprint.pose).corners()
        yield np.concatenate([corners, corners[:1]])
