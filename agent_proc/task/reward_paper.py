"""The published reward (Eqs. 15 to 17), by its terms."""

from dataclasses import dataclass
from math import sqrt
from typing import Final

from agent_proc.frames.push_view import PushView

POSITION_WEIGHT: Final = 10.0
ANGLE_WEIGHT: Final = 2.0
FALL_PENALTY: Final = 10.0


@dataclass(frozen=True, kw_only=True)
class PaperReward:
    """The terms of the reward, none of them positive; their sum is `R = r_position + r_angle - 10 fall`."""

    position: float
    angle: float
    fall: float


def paper_reward(view: PushView) -> PaperReward:
    """The reward of a state.

    `r_position = -10 (sqrt(e1) + sqrt(e2))` with `e_i` the squared planar error of tracked corner i, front
    left and front right; `r_angle = -2 sqrt(e_angle)` with `e_angle` the squared, wrapped error of the yaw.
    """
    errors_m = view.corners_w_m[:, :2] - view.goal_corners_w_m
    e1, e2 = (errors_m**2).sum(axis=1).tolist()
    e_angle = view.error.angle_rad**2
    return PaperReward(
        position=-POSITION_WEIGHT * (sqrt(e1) + sqrt(e2)),
        angle=-ANGLE_WEIGHT * sqrt(e_angle),
        fall=-FALL_PENALTY if view.fallen else 0.0,
    )
