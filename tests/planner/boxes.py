"""Queries for paths of the box, and the check of a plan by other means than the planner's."""

from itertools import groupby, pairwise
from math import hypot, pi
from typing import Any

import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2, wrap_angle
from legpush.messages.planning import BoxPathQuery, Plan, PushSide
from legpush.scene.footprints import Footprint, distance_m, distance_to_border_m, obstacle_footprint
from legpush.scene.occupancy import occupancy_grid
from legpush.scene.scenario import Room
from tests.planner.maps import pose

OPEN = Room(size_m=(8.0, 8.0))
RADIUS_M = 0.7
CLEARANCE_M = 0.05
WALK_M = 0.4


def side(turn_rad: float, length_m: float, width_m: float, axle_m: float = 0.15) -> PushSide:
    """A face of the box with the robot behind it, and the place where the robot's walk to it ends."""
    behind = axle_m - length_m / 2
    return PushSide(
        frame=pose(0.0, 0.0, turn_rad) @ pose(-axle_m, 0.0),
        min_turning_radius_m=RADIUS_M,
        footprints=(
            Footprint(pose=pose(axle_m, 0.0), length_m=length_m, width_m=width_m),
            Footprint(pose=pose(behind - 0.42, 0.0), length_m=0.76, width_m=0.44),
        ),
        stand_off=pose(behind - 0.75, 0.0),
    )


SIDES = (side(0.0, 0.4, 0.5), side(pi / 2, 0.5, 0.4), side(pi, 0.4, 0.5), side(-pi / 2, 0.5, 0.4))


def query(room: Room, start: Pose2, goal: Pose2, **changes: Any) -> BoxPathQuery:
    """A query for a path of the box, with defaults that `changes` replaces."""
    fields: dict[str, Any] = {
        "sides": SIDES,
        "present_side": None,
        "box": Footprint(pose=pose(0.0, 0.0), length_m=0.4, width_m=0.5),
        "walk_clearance_m": WALK_M,
        "side_change_m": 0.5,
        "clearance_m": CLEARANCE_M,
        "run_in_m": 0.4,
        "position_tolerance_m": 0.01,
        "angle_tolerance_rad": 0.02,
        "seed": 1,
        "max_iterations": 1500,
        "goal_bias": 0.1,
        "step_m": 1.0,
    }
    return BoxPathQuery(grid=occupancy_grid(room), start=start, goal=goal, **(fields | changes))


def check(asked: BoxPathQuery, room: Room, plan: Plan) -> None:
    """Everything that an exact plan promises, measured by other means than the planner's."""
    assert plan.status == "exact", plan.reason
    assert len(plan.sides) == len(plan.waypoints)
    first, last = plan.waypoints[0], plan.waypoints[-1]
    assert first.xy() == pytest.approx(asked.start.xy())
    assert hypot(*(last.xy() - asked.goal.xy())) <= asked.position_tolerance_m + 1e-9
    assert abs(wrap_angle(last.yaw_rad - asked.goal.yaw_rad)) <= asked.angle_tolerance_rad + 1e-9
    length_m = 0.0
    for (side_a, a), (side_b, b) in pairwise(zip(plan.sides, plan.waypoints, strict=True)):
        if side_a != side_b:
            assert [*b.xy(), b.yaw_rad] == pytest.approx([*a.xy(), a.yaw_rad]), "it stays while the robot changes sides"
            continue
        frame = asked.sides[side_b].frame
        moved = (a @ frame).inverse() @ (b @ frame)
        step_m = hypot(moved.x_m, moved.y_m)
        length_m += step_m
        assert moved.x_m >= -1e-9
        assert abs(moved.y_m) <= step_m**2 / RADIUS_M + 1e-9, "it does not slip sideways"
        assert abs(moved.yaw_rad) <= 1.01 * step_m / RADIUS_M + 1e-9
        assert step_m < 0.03
    assert length_m == pytest.approx(plan.length_m, rel=1e-3, abs=1e-6)
    least_m = min(clearances(asked, room, plan))
    assert least_m >= CLEARANCE_M - 1e-6
    assert least_m >= plan.min_clearance_m - 1e-6


def clearances(asked: BoxPathQuery, room: Room, plan: Plan) -> list[float]:
    """Distances of every footprint at every waypoint to walls and obstacles."""
    found = []
    for index, waypoint in zip(plan.sides, plan.waypoints, strict=True):
        for footprint in asked.sides[index].footprints:
            placed = replace(footprint, pose=waypoint @ asked.sides[index].frame @ footprint.pose)
            found.append(distance_to_border_m(placed.corners(), room))
            found += [distance_m(placed, obstacle_footprint(obstacle)) for obstacle in room.obstacles]
    return found


def faces(plan: Plan) -> list[int]:
    """The sides of a plan in their order, each stretch once."""
    return [index for index, _ in groupby(plan.sides)]
