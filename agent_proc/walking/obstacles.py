"""Obstacles that appear: what is known of the scenario, and whether a new obstacle stands in the way of a walk.

A path is kept if a new obstacle leaves it the clearance that it was planned with; else another one is planned.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.errors import BadAnswerError
from legpush.geometry import Pose2
from legpush.messages.stepping import Appearance, WorldState
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.occupancy import clearance_m, room_by_now
from legpush.scene.paths import travelled_m
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
    """Whether an obstacle is nearer than the planner's clearance to what is left of a path of the trunk."""
    ahead = _ahead_m(waypoints, from_m, scenario.robot.stance.foot_circle_m)
    low = np.array([obstacle.x_min_m, obstacle.y_min_m]) - ahead
    high = ahead - np.array([obstacle.x_max_m, obstacle.y_max_m])
    apart = np.hypot(*np.maximum(np.maximum(low, high), 0.0).T)
    return bool(apart.min() < clearance_m(scenario))


def _ahead_m(waypoints: Sequence[Pose2], from_m: float, foot_circle_m: float) -> Floats:
    """Places on a path from a travelled length on, (n, 2)."""
    at_m = travelled_m(waypoints, foot_circle_m)
    where = np.append(np.arange(min(from_m, at_m[-1]), at_m[-1], LOOK_STEP_M), at_m[-1])
    return np.stack(
        [np.interp(where, at_m, [p.x_m for p in waypoints]), np.interp(where, at_m, [p.y_m for p in waypoints])],
        axis=-1,
    )
