"""Planar poses of the bodies in a world state."""

from legpush.geometry import Pose2, rpy_from_quaternion
from legpush.messages.stepping import BoxState, TrunkState


def planar_pose(body: TrunkState | BoxState) -> Pose2:
    """The pose of a body, projected to the floor, world frame."""
    x_m, y_m, _ = body.position_m
    return Pose2(x_m=x_m, y_m=y_m, yaw_rad=float(rpy_from_quaternion(body.orientation_wxyz)[2]))
