"""Signed distances between rectangles on the floor, negative if they overlap."""

import msgspec
import numpy as np

from legpush.arrays import Floats
from legpush.bounds import QueryLength
from legpush.geometry import Pose2, rectangle_corners
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Rectangle, Room


class Footprint(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A rectangle anywhere on the floor: `length_m` along the x axis of its centre's pose, `width_m` along y."""

    pose: Pose2
    length_m: QueryLength
    width_m: QueryLength

    def corners(self) -> Floats:
        """Return the corners, counter-clockwise from front left, world frame, (4, 2)."""
        return self.pose.apply(rectangle_corners(self.length_m, self.width_m))


def box_footprint(box: Box, pose: Pose2) -> Footprint:
    """Return the floor that the box covers when its centre is at `pose`."""
    return Footprint(pose=pose, length_m=box.size_m[0], width_m=box.size_m[1])


def robot_footprint(robot: RobotSpec, trunk: Pose2) -> Footprint:
    """Return the floor that the robot covers, its knees included."""
    stance = robot.stance
    return Footprint(
        pose=trunk @ Pose2(x_m=(stance.body_front_m - stance.body_rear_m) / 2, y_m=0.0, yaw_rad=0.0),
        length_m=stance.body_front_m + stance.body_rear_m,
        width_m=stance.body_width_m,
    )


def foot_rectangle(robot: RobotSpec, trunk: Pose2) -> Footprint:
    """Return the rectangle at whose corners the feet stand."""
    stance = robot.stance
    return Footprint(pose=trunk, length_m=stance.foot_rectangle_length_m, width_m=stance.foot_rectangle_width_m)


def behind_box(box: Box, pose: Pose2, distance_m: float) -> Pose2:
    """Return the pose `distance_m` behind the rear face of the box at `pose`, with the heading of the box."""
    return pose @ Pose2(x_m=-box.size_m[0] / 2 - distance_m, y_m=0.0, yaw_rad=0.0)


def obstacle_footprint(obstacle: Rectangle) -> Footprint:
    """Return the rectangle of an obstacle as a footprint."""
    return Footprint(
        pose=Pose2(
            x_m=(obstacle.x_min_m + obstacle.x_max_m) / 2,
            y_m=(obstacle.y_min_m + obstacle.y_max_m) / 2,
            yaw_rad=0.0,
        ),
        length_m=obstacle.x_max_m - obstacle.x_min_m,
        width_m=obstacle.y_max_m - obstacle.y_min_m,
    )


def distance_to_border_m(points: Floats, room: Room) -> float:
    """Return the least distance of `points`, (n, 2), to the border of the room; negative outside."""
    return float(np.minimum(points, np.asarray(room.size_m) - points).min())


def distance_to_point_m(footprint: Footprint, point: Floats) -> float:
    """Return the distance from the border of the footprint to a point, (2,); negative inside."""
    beyond = np.abs(footprint.pose.inverse().apply(point)) - np.array([footprint.length_m, footprint.width_m]) / 2
    return float(np.hypot(*np.maximum(beyond, 0.0)) + min(beyond.max(), 0.0))


def distance_m(a: Footprint, b: Footprint) -> float:
    """Return the distance between two footprints; if they overlap, minus the shortest shift that separates them."""
    corners_a, corners_b = a.corners(), b.corners()
    separation = max(_separation(a, corners_b), _separation(b, corners_a))
    if separation <= 0.0:
        return separation
    return min(
        *(distance_to_point_m(a, corner) for corner in corners_b),
        *(distance_to_point_m(b, corner) for corner in corners_a),
    )


def _separation(footprint: Footprint, corners: Floats) -> float:
    """Return the largest gap along the footprint's own two axes between it and a convex polygon, (n, 2)."""
    seen = footprint.pose.inverse().apply(corners)
    half = np.array([footprint.length_m, footprint.width_m]) / 2
    return float(np.maximum(seen.min(axis=0) - half, -half - seen.max(axis=0)).max())
