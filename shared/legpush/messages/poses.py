"""Planar poses of the bodies in a world state, and the state as it is perceived."""

from math import cos, sin

from msgspec.structs import replace

from legpush.geometry import Point3, Pose2, Quaternion, rpy_from_quaternion
from legpush.messages.stepping import BoxState, TrunkState, WorldState


def planar_pose(body: TrunkState | BoxState) -> Pose2:
    """The pose of a body, projected to the floor, world frame."""
    x_m, y_m, _ = body.position_m
    return Pose2(x_m=x_m, y_m=y_m, yaw_rad=float(rpy_from_quaternion(body.orientation_wxyz)[2]))


def as_seen(world: WorldState) -> WorldState:
    """The state as the robot and its agent know it, with nothing in it that they do not: for deciding what to do.

    The robot stands where it is taken to be, with its feet and all that is measured aboard, and the box where it was
    seen last. What is judged is judged by the state itself.
    """
    if world.perceived is None:
        return world
    moved = world.perceived.trunk @ planar_pose(world.trunk).inverse()
    fl, fr, rl, rr = (_moved(tip, moved) for tip in world.tips_m)
    return replace(
        world,
        trunk=TrunkState(
            position_m=_moved(world.trunk.position_m, moved),
            orientation_wxyz=_turned(world.trunk.orientation_wxyz, moved.yaw_rad),
            linear_velocity_m_s=_along(world.trunk.linear_velocity_m_s, moved.yaw_rad),
            angular_velocity_rad_s=_along(world.trunk.angular_velocity_rad_s, moved.yaw_rad),
        ),
        tips_m=(fl, fr, rl, rr),
        imu=replace(world.imu, orientation_wxyz=_turned(world.imu.orientation_wxyz, moved.yaw_rad)),
        box=world.perceived.box,
        perceived=None,
    )


def _moved(point_m: Point3, moved: Pose2) -> Point3:
    x, y, z = _along(point_m, moved.yaw_rad)
    return moved.x_m + x, moved.y_m + y, z


def _along(vector: Point3, yaw_rad: float) -> Point3:
    """A vector that is turned about the vertical."""
    (x, y, z), c, s = vector, cos(yaw_rad), sin(yaw_rad)
    return c * x - s * y, s * x + c * y, z


def _turned(orientation_wxyz: Quaternion, yaw_rad: float) -> Quaternion:
    """An orientation that is turned about the vertical."""
    (w, x, y, z), c, s = orientation_wxyz, cos(yaw_rad / 2), sin(yaw_rad / 2)
    return c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w
