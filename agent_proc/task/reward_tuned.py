"""The reward profile `tuned`: progress in tolerances, positive or negative, and bonuses for the end.

Progress is the difference of a potential, so a way there and back earns nothing. Its sum is bounded by the errors at
the start, and a fall costs more than that: falling never pays.
"""

from math import degrees, exp
from typing import Final

from agent_proc.frames.push_view import PushView

POSITION_WEIGHT: Final = 0.1
"""Per tolerance of the position that the error shrinks."""
STEERING_WEIGHT: Final = 0.3
"""Per tolerance of the angle that the steering error shrinks: it shows at once whether the leg was the right one."""
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
"""In addition to the loss of all progress."""


def errors_in_tolerances(view: PushView) -> tuple[float, float]:
    """Errors of position and angle, each as a multiple of its tolerance."""
    error, goal = view.error, view.goal
    return error.position_m / goal.position_tolerance_m, degrees(error.angle_rad) / goal.angle_tolerance_deg


def steering_in_tolerances(view: PushView) -> float:
    """Steering error as a multiple of the tolerance of the angle."""
    return abs(degrees(view.steering_error_rad)) / view.goal.angle_tolerance_deg


def tuned_reward(first: PushView, before: PushView, after: PushView, *, arrived: bool) -> dict[str, float]:
    """The terms of a step from `before` to `after` in an episode that began at `first`.

    `arrived` is whether the episode ended where no push brings the box nearer.
    """
    since = first if after.fallen else after
    position, _ = errors_in_tolerances(before)
    position_after, angle_after = errors_in_tolerances(since)
    within = after.error.within(after.goal)
    return {
        "position": POSITION_WEIGHT * (position - position_after),
        "steering": STEERING_WEIGHT * (steering_in_tolerances(before) - steering_in_tolerances(since)),
        "cycle": -CYCLE_COST,
        "success": SUCCESS_BONUS if arrived and within else 0.0,
        "precision": PRECISION_BONUS * exp(-POSITION_DECAY * position_after - ANGLE_DECAY * angle_after)
        if arrived
        else 0.0,
        "fall": -FALL_PENALTY if after.fallen else 0.0,
    }
