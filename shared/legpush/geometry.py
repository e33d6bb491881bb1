"""Planar poses and rotations: radians, metres, x forward, y left, yaw counter-clockwise."""

from math import atan2, cos, hypot, pi, sin
from typing import Final

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from legpush.arrays import Floats
from legpush.bounds import Coordinate, QuaternionPart, Reading, Yaw

Point2 = tuple[Coordinate, Coordinate]
"""x and y."""
Point3 = tuple[Reading, Reading, Reading]
"""x, y and z, as measured."""
Quaternion = tuple[QuaternionPart, QuaternionPart, QuaternionPart, QuaternionPart]
"""w, x, y and z."""


class Pose2(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A pose in the plane of the floor, in the world frame unless its name says otherwise."""

    x_m: Coordinate
    y_m: Coordinate
    yaw_rad: Yaw

    def __matmul__(self, other: "Pose2") -> "Pose2":
        """Compose: `world_from_a @ a_from_b` is `world_from_b`."""
        c, s = cos(self.yaw_rad), sin(self.yaw_rad)
        return Pose2(
            x_m=self.x_m + c * other.x_m - s * other.y_m,
            y_m=self.y_m + s * other.x_m + c * other.y_m,
            yaw_rad=wrap_angle(self.yaw_rad + other.yaw_rad),
        )

    def inverse(self) -> "Pose2":
        """Return the inverse pose: `b_from_a` of `a_from_b`."""
        c, s = cos(self.yaw_rad), sin(self.yaw_rad)
        return Pose2(
            x_m=-c * self.x_m - s * self.y_m,
            y_m=s * self.x_m - c * self.y_m,
            yaw_rad=wrap_angle(-self.yaw_rad),
        )

    def xy(self) -> Floats:
        """Return the position, (2,)."""
        return np.array([self.x_m, self.y_m])

    def apply(self, points: ArrayLike) -> Floats:
        """Transform points, (n, 2), from this pose's frame to the frame in which the pose is given."""
        c, s = cos(self.yaw_rad), sin(self.yaw_rad)
        rotation = np.array([[c, -s], [s, c]])
        turned: Floats = np.asarray(points, dtype=np.float64) @ rotation.T
        return turned + self.xy()


ORIGIN: Final = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
"""The pose of a frame in itself."""


def wrap_angle(angle_rad: float) -> float:
    """Return the same angle in (-pi, pi]."""
    wrapped = atan2(sin(angle_rad), cos(angle_rad))
    return pi if wrapped == -pi else wrapped


def rectangle_corners(length_m: float, width_m: float) -> Floats:
    """Return the corners of a rectangle about the origin, counter-clockwise from front left, (4, 2)."""
    x, y = length_m / 2, width_m / 2
    return np.array([[x, y], [-x, y], [-x, -y], [x, -y]])


def rotation_from_rpy(roll_rad: float, pitch_rad: float, yaw_rad: float) -> Floats:
    """Return the world-from-body rotation `Rz(yaw) Ry(pitch) Rx(roll)` (Eq. 1), (3, 3)."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll_rad, pitch_rad, yaw_rad) for f in (cos, sin))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_from_quaternion(quaternion_wxyz: ArrayLike) -> Floats:
    """Return roll, pitch and yaw of unit quaternions, (..., 4) to (..., 3)."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion_wxyz, dtype=np.float64), -1, 0)
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.stack([roll, pitch, yaw], axis=-1)


def distance_m(a: Pose2, b: Pose2) -> float:
    """Return the distance between the positions of two poses."""
    return hypot(a.x_m - b.x_m, a.y_m - b.y_m)
