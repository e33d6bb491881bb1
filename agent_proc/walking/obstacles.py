"""Obstacles that appear: what is known of the scenario, and whether a new obstacle stands in the way of a walk.

A path is kept if a new obstacle leaves it the clearance that it was planned with; else another one is planned.
"""

from collections.abc import Sequence
from typing import Final

from msgspec.structs import replace

from legpush.errors import BadAnswerError
from legpush.geometry import Pose2
from legpush.messages.stepping import Appearance, WorldState
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.footprints import (
    box_footprint,
    distance_m,
    distance_to_border_m,
    distance_to_point_m,
    obstacle_footprint,
    robot_footprint,
)
from legpush.scene.occupancy import clearance_m, room_by_now
from legpush.scene.paths import poses_along
from legpush.scene.scenario import Rectangle, Scenario

LOOK_STEP_M: Final = 0.05
"""Distance between the places of a path that are checked."""


def known_scenario(scenario: Scenario, state: WorldState) -> Scenario:
    """The scenario without the obstacles that have not appeared.

    Raises:
        BadAnswerError: An obstacle is reported that cannot appear.
    """
    obstacles = scenario.room.obstacles
    for each in state.appeared:
        if each.obstacle >= len(obstacles) or obstacles[each.obstacle].appears_at_s == 0.0:
            later = [str(index) for index, obstacle in enumerate(obstacles) if obstacle.appears_at_s > 0.0]
            raise BadAnswerError(
                f"Expected in `appeared` at tick {state.tick} an obstacle that appears later "
                f"({', '.join(later) or 'there is none'}), got {each.obstacle}"
            )
    room = room_by_now(scenario.room, {each.obstacle for each in state.appeared})
    return scenario if room is scenario.room else replace(scenario, room=room)


def in_words(appeared: Sequence[Appearance]) -> str:
    """Which obstacles have appeared, and when."""
    return ", ".join(f"room.obstacles[{each.obstacle}] at {each.tick * CONTROL_PERIOD_S:.1f} s" for each in appeared)


def is_in_walk(obstacle: Rectangle, scenario: Scenario, waypoints: Sequence[Pose2], from_m: float = 0.0) -> bool:
    """Whether an obstacle is nearer than the planner's clearances to what is left of a path of the trunk."""
    robot, place, margin_m = scenario.robot, obstacle_footprint(obstacle), scenario.planning.body_margin_m
    ahead = poses_along(waypoints, robot.stance.foot_circle_m, from_m, LOOK_STEP_M)
    return any(distance_to_point_m(place, pose.xy()) < clearance_m(scenario) for pose in ahead) or any(
        distance_m(place, robot_footprint(robot, pose)) < margin_m for pose in ahead
    )


def has_clearance(scenario: Scenario, trunk: Pose2, box: Pose2) -> bool:
    """Whether the robot at a place keeps the planner's clearances, so that another path may begin there."""
    least_m = clearance_m(scenario) + scenario.room.resolution_m
    if distance_to_border_m(trunk.xy()[None], scenario.room) < least_m:
        return False
    if distance_to_point_m(box_footprint(scenario.box, box), trunk.xy()) < least_m:
        return False
    return not any(is_in_walk(obstacle, scenario, (trunk,)) for obstacle in scenario.room.obstacles)
