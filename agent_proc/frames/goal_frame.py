"""The box as its goal sees it, how it should head there, and whether the mirror image of that is looked at."""

from math import atan2
from typing import Final

from agent_proc.frames.poses import planar_pose
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.stepping import WorldState
from legpush.scene.scenario import Scenario

LOOK_AHEAD_M: Final = 0.25
"""How far ahead on the line through the goal a box should head for."""
N_DIGITS: Final = 9
"""Which side the box is on is decided by this many decimals of a metre."""


def box_in_goal_frame(world: WorldState, scenario: Scenario) -> Pose2:
    """Pose of the box in the frame of its goal pose: x is minus the distance that remains."""
    return scenario.goal.pose.pose().inverse() @ planar_pose(world.box)


def steering_error_rad(box: Pose2) -> float:
    """Heading of a box at this pose in the goal frame, less the heading that brings it to the line (pure pursuit)."""
    return wrap_angle(box.yaw_rad - atan2(-box.y_m, LOOK_AHEAD_M))


def mirror_sign(world: WorldState, scenario: Scenario) -> float:
    """-1 where the middle of the box's leading edge is right of the line through the goal, else 1."""
    half_length_m = scenario.box.size_m[0] / 2
    edge = box_in_goal_frame(world, scenario) @ Pose2(x_m=half_length_m, y_m=0.0, yaw_rad=0.0)
    return -1.0 if round(edge.y_m, N_DIGITS) < 0.0 else 1.0
