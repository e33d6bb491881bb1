"""Places of the robot at the box: the station to push from, and the stand-off, where planned paths end."""

from collections.abc import Sequence
from math import ceil, hypot, radians, sin
from typing import Final

from legpush.geometry import Pose2, distance_m, wrap_angle
from legpush.realism.settings import Randomization
from legpush.scene.footprints import (
    Footprint,
    behind_box,
    box_footprint,
    distance_to_border_m,
    distance_to_point_m,
    obstacle_footprint,
    robot_footprint,
)
from legpush.scene.footprints import distance_m as footprint_distance_m
from legpush.scene.occupancy import clearance_m
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Scenario

LAST_STRETCH_STEP_M: Final = 0.05
BACK_STEP_M: Final = 0.05
ROUNDING_M: Final = 1e-9
"""Distances that differ by less count as equal."""
CELLS: Final = 1.5
"""An occupied cell may extend this many cells beyond the object in it."""


def station(robot: RobotSpec, box: Box, box_pose: Pose2) -> Pose2:
    """Return the trunk's pose from which a box at `box_pose` is pushed along its x axis."""
    return behind_box(box, box_pose, robot.station_m)


def at_station(robot: RobotSpec, trunk: Pose2, box: Box, box_pose: Pose2) -> bool:
    """Return whether a robot with its trunk at `trunk` can push from there."""
    place = station(robot, box, box_pose)
    turn_rad = abs(wrap_angle(trunk.yaw_rad - place.yaw_rad))
    return distance_m(trunk, place) <= robot.pushing.at_station_m and turn_rad <= radians(robot.pushing.at_station_deg)


def stand_off(scenario: Scenario, box: Box, box_pose: Pose2) -> Pose2:
    """Return the trunk's pose behind the box where a planned path ends.

    It is `robot.pushing.stand_off_m` behind the box, or farther if needed to keep the planner's clearance from every
    cell that `nominal_obstacle` touches.
    """
    cells_m = 2 * scenario.room.resolution_m
    needed_m = clearance_m(scenario) + box_reach_m(scenario.box, scenario.randomization) + cells_m
    return behind_box(box, box_pose, max(scenario.robot.pushing.stand_off_m, needed_m))


def last_stretch(scenario: Scenario, box: Box, box_pose: Pose2) -> tuple[Pose2, ...]:
    """Return waypoints straight ahead from the stand-off, not included, to the station, with the heading of the box."""
    begin, end = stand_off(scenario, box, box_pose), station(scenario.robot, box, box_pose)
    n_steps = ceil(distance_m(begin, end) / LAST_STRETCH_STEP_M)
    return tuple(
        Pose2(
            x_m=begin.x_m + (end.x_m - begin.x_m) * k / n_steps,
            y_m=begin.y_m + (end.y_m - begin.y_m) * k / n_steps,
            yaw_rad=end.yaw_rad,
        )
        for k in range(1, n_steps + 1)
    )


def way_back(scenario: Scenario, trunk: Pose2, box_pose: Pose2) -> tuple[Pose2, ...]:
    """Return waypoints straight back from the box, up to the first with space to turn around, or as far as possible.

    On the way, the body keeps the clearance of planned paths. If it is nearer to something now, it comes no nearer.
    """
    solid = [*map(obstacle_footprint, scenario.room.obstacles), box_footprint(scenario.box, box_pose)]
    pushing = scenario.robot.pushing
    way = [trunk]
    required_m = min(scenario.planning.body_margin_m, body_space_m(scenario, trunk, solid))
    while len(way) * BACK_STEP_M <= pushing.most_back_m:
        back = trunk @ Pose2(x_m=-BACK_STEP_M * len(way), y_m=0.0, yaw_rad=0.0)
        if body_space_m(scenario, back, solid) < max(required_m, 0.0) - ROUNDING_M:
            break
        way.append(back)
        if len(way) * BACK_STEP_M > pushing.least_back_m and can_turn(scenario, back, box_pose):
            break
    return tuple(way)


def body_space_m(scenario: Scenario, trunk: Pose2, solid: Sequence[Footprint]) -> float:
    """Return the distance of the robot's body from solid things and the border of the room; negative if it overlaps."""
    body = robot_footprint(scenario.robot, trunk)
    to_border_m = distance_to_border_m(body.corners(), scenario.room)
    return min([to_border_m, *(footprint_distance_m(body, other) for other in solid)])


def can_turn(scenario: Scenario, trunk: Pose2, box_pose: Pose2) -> bool:
    """Return whether the robot can turn to any heading at a place, and a path can be planned from there."""
    solid = [*map(obstacle_footprint, scenario.room.obstacles), box_footprint(scenario.box, box_pose)]
    space_m = min(
        distance_to_border_m(trunk.xy()[None], scenario.room),
        *(distance_to_point_m(other, trunk.xy()) for other in solid),
    )
    return space_m >= scenario.robot.stance.body_circle_m + CELLS * scenario.room.resolution_m


def box_reach_m(box: Box, offsets: Randomization) -> float:
    """Return the largest distance by which the seed may move any point of the box from its nominal place."""
    half_diagonal_m = hypot(*box.size_m[:2]) / 2
    turn_m = 2 * half_diagonal_m * sin(radians(min(offsets.box_yaw_deg, 180.0)) / 2)
    return hypot(offsets.box_xy_m, offsets.box_xy_m) + turn_m


def nominal_obstacle(scenario: Scenario) -> Footprint:
    """Return a rectangle that covers the box for every seed; more is not known before the box is in sight."""
    reach_m = box_reach_m(scenario.box, scenario.randomization)
    nominal = box_footprint(scenario.box, scenario.box.pose.pose())
    return Footprint(pose=nominal.pose, length_m=nominal.length_m + 2 * reach_m, width_m=nominal.width_m + 2 * reach_m)
