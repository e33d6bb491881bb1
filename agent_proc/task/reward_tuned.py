"""The reward profile `tuned`: every tolerance gained is paid, every one lost is taken back, and the end counts.

Progress is the difference of a potential, so no way there and back earns anything. What it can add up to is bounded by
the errors at the start, what a fall costs is more than that: falling never pays.
"""

from math import degrees, exp
from typing import Final

from agent_proc.frames.goal_frame import box_in_goal_frame, steering_error_rad
from agent_proc.frames.poses import box_error
from legpush.messages.stepping import WorldState
from legpush.scene.scenario import Scenario

POSITION_WEIGHT: Final = 0.1
"""Per tolerance of the position that the error shrinks."""
STEERING_WEIGHT: Final = 0.3
"""Per tolerance of the angle that the heading comes nearer to the one that brings the box to the goal's line: right or
wrong of a leg shows at once."""
CYCLE_COST: Final = 0.02
"""Of each push cycle."""
SUCCESS_BONUS: Final = 3.0
"""For an end within the tolerances."""
PRECISION_BONUS: Final = 6.0
"""For an end without any error; it decays with both errors."""
POSITION_DECAY: Final = 2.0
ANGLE_DECAY: Final = 3.0
"""Per tolerance of the error."""
FALL_PENALTY: Final = 20.0
"""Besides all progress that was made: it is taken back."""


def errors_in_tolerances(world: WorldState, scenario: Scenario) -> tuple[float, float]:
    """Errors of position and angle, each as a multiple of its tolerance."""
    error = box_error(world, scenario)
    goal = scenario.goal
    return error.position_m / goal.position_tolerance_m, degrees(error.angle_rad) / goal.angle_tolerance_deg


def steering_in_tolerances(world: WorldState, scenario: Scenario) -> float:
    """Steering error as a multiple of the tolerance of the angle."""
    error_rad = steering_error_rad(box_in_goal_frame(world, scenario))
    return abs(degrees(error_rad)) / scenario.goal.angle_tolerance_deg


def tuned_reward(
    first: WorldState, before: WorldState, after: WorldState, scenario: Scenario, *, arrived: bool
) -> dict[str, float]:
    """The terms of a step from `before` to `after` in an episode that began at `first`.

    `arrived` is whether the episode ended where no push brings the box nearer.
    """
    since = first if after.fallen else after
    position, _ = errors_in_tolerances(before, scenario)
    position_after, angle_after = errors_in_tolerances(since, scenario)
    within = box_error(after, scenario).within(scenario.goal)
    return {
        "position": POSITION_WEIGHT * (position - position_after),
        "steering": STEERING_WEIGHT
        * (steering_in_tolerances(before, scenario) - steering_in_tolerances(since, scenario)),
        "cycle": -CYCLE_COST,
        "success": SUCCESS_BONUS if arrived and within else 0.0,
        "precision": PRECISION_BONUS * exp(-POSITION_DECAY * position_after - ANGLE_DECAY * angle_after)
        if arrived
        else 0.0,
        "fall": -FALL_PENALTY if after.fallen else 0.0,
    }
