"""The published reward (Eqs. 15 to 17), by its terms."""

from dataclasses import dataclass
from math import sqrt
from typing import Final

from agent_proc.frames.corners import goal_corners_m, tracked_corners_m
from agent_proc.frames.poses import box_error
from legpush.messages.stepping import WorldState
from legpush.scene.scenario import Scenario

POSITION_WEIGHT: Final = 10.0
ANGLE_WEIGHT: Final = 2.0
FALL_PENALTY: Final = 10.0


@dataclass(frozen=True, kw_only=True)
class PaperReward:
    """The terms of the reward, none of them positive."""

    position: float
    angle: float
    fall: float

    @property
    def total(self) -> float:
        """Their sum, `R = r_position + r_angle - 10 fall`."""
        return self.position + self.angle + self.fall


def paper_reward(world: WorldState, scenario: Scenario) -> PaperReward:
    """The reward of a state.

    `r_position = -10 (sqrt(e1) + sqrt(e2))` with `e_i` the squared planar error of tracked corner i, front
    left and front right; `r_angle = -2 sqrt(e_angle)` with `e_angle` the squared, wrapped error of the yaw.
    """
    errors_m = tracked_corners_m(world.box, scenario.box)[:, :2] - goal_corners_m(scenario)
    e1, e2 = (errors_m**2).sum(axis=1).tolist()
    e_angle = box_error(world, scenario).angle_rad ** 2
    return PaperReward(
        position=-POSITION_WEIGHT * (sqrt(e1) + sqrt(e2)),
        angle=-ANGLE_WEIGHT * sqrt(e_angle),
        fall=-FALL_PENALTY if world.fallen else 0.0,
    )
