"""The box as its goal sees it, and whether the mirror image of that is looked at."""

from typing import Final

from agent_proc.poses import planar_pose
from legpush.geometry import Pose2
from legpush.messages import WorldState
from legpush.scenario import Scenario

N_DIGITS: Final = 9
"""Which side the box is on is decided by this many decimals of a metre."""


def box_in_goal_frame(world: WorldState, scenario: Scenario) -> Pose2:
    """Pose of the box in the frame of its goal pose: x is minus the distance that remains."""
    return scenario.goal.pose.pose().inverse() @ planar_pose(world.box)


def mirror_sign(world: WorldState, scenario: Scenario) -> float:
    """-1 where the middle of the box's leading edge is right of the line through the goal, else 1."""
    half_length_m = scenario.box.size_m[0] / 2
    edge = box_in_goal_frame(world, scenario) @ Pose2(x_m=half_length_m, y_m=0.0, yaw_rad=0.0)
    return -1.0 if round(edge.y_m, N_DIGITS) < 0.0 else 1.0
