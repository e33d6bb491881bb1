"""The loss of an episode: one number for both errors, in tolerances of the goal."""

from typing import Final

from legpush.scene.scenario import Goal

MOST: Final = 10.0
"""The loss of an episode that the policy did not end by itself, and the most that an error costs (our choice)."""


def episode_loss(ended: bool, position_error_m: float, angle_error_deg: float, goal: Goal) -> float:
    """The larger of the errors of position and angle, each over its tolerance; at most 1 is a success.

    `ended` says whether the policy ended the episode by itself: time-outs, falls and boxes out of reach cost the most.
    """
    if not ended:
        return MOST
    return min(MOST, max(position_error_m / goal.position_tolerance_m, angle_error_deg / goal.angle_tolerance_deg))
