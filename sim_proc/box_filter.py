"""Where the box is, from all looks at it: a Kalman filter of a body that stands still unless a foot moves it."""

import struct
from math import cos, hypot, radians, sin
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.realism.reality import Sensed
from legpush.scene.scenario import Box

NEAR_M: Final = 0.06
"""A foot whose centre is this near the box may move it: its radius and 4 cm."""
MOVES_M: Final = 0.02
MOVES_RAD: Final = radians(3.0)
"""Standard deviation of the motion in a tick in which a foot may move the box. Five such ticks from one look to the
next are several times the noise of a look, so that the filter then follows what it sees."""
SURPRISE: Final = 4.0
"""A look this many standard deviations beside what was expected says that the box was moved unseen."""
LEAST_SHARE: Final = 0.02
"""Least weight of a new look. It averages over about a hundred looks at most."""


class BoxFilter:
    """The planar pose of a box and its variance; place and heading are filtered apart."""

    def __init__(self, box: Box, sensed: Sensed, first: Pose2) -> None:
        """Begin with a first look."""
        self._half_m = box.size_m[0] / 2, box.size_m[1] / 2
        self._noise = sensed.noise_m**2, radians(sensed.noise_deg) ** 2
        """Variances of a look: of x and y each, [m^2], and of the heading, [rad^2]."""
        self.pose = first
        """The best estimate of where the box was at the time of the last look."""
        self._variances = self._noise
        self.n_moving = 0
        """Number of ticks up to now in which a foot may have moved the box."""
        self._n_included = 0
        """How many of them there were at the time of the last look."""

    def pass_ticks(self, tips_m: Floats) -> None:
        """Take note of where the feet are at the ends of ticks, (n, 4, 3)."""
        dx, dy = tips_m[..., 0] - self.pose.x_m, tips_m[..., 1] - self.pose.y_m
        c, s = cos(self.pose.yaw_rad), sin(self.pose.yaw_rad)
        half_x_m, half_y_m = self._half_m
        ahead = np.maximum(np.abs(c * dx + s * dy) - half_x_m, 0.0)
        beside = np.maximum(np.abs(c * dy - s * dx) - half_y_m, 0.0)
        near = ahead * ahead + beside * beside < NEAR_M**2
        self.n_moving += int(np.count_nonzero(near.any(axis=1)))

    def look(self, seen: Pose2, n_moving: int) -> None:
        """Take in a look that was made when `n_moving` ticks had moved the box."""
        moved, self._n_included = n_moving - self._n_included, n_moving
        before_m2, before_rad2 = self._variances
        off_m = seen.x_m - self.pose.x_m, seen.y_m - self.pose.y_m
        off_rad = wrap_angle(seen.yaw_rad - self.pose.yaw_rad)
        share_m, after_m2 = _weighed(before_m2 + moved * MOVES_M**2, self._noise[0], hypot(*off_m))
        share_rad, after_rad2 = _weighed(before_rad2 + moved * MOVES_RAD**2, self._noise[1], abs(off_rad))
        self._variances = after_m2, after_rad2
        self.pose = Pose2(
            x_m=self.pose.x_m + share_m * off_m[0],
            y_m=self.pose.y_m + share_m * off_m[1],
            yaw_rad=wrap_angle(self.pose.yaw_rad + share_rad * off_rad),
        )

    def as_bytes(self) -> bytes:
        """All that it knows."""
        pose = self.pose
        numbers = pose.x_m, pose.y_m, pose.yaw_rad, *self._variances
        return struct.pack("<5d2q", *numbers, self.n_moving, self._n_included)


def _weighed(before: float, noise: float, off: float) -> tuple[float, float]:
    """Return the weight of a look that is `off` from what was expected, and the variance after it."""
    if noise == 0.0:
        return 1.0, 0.0
    if off**2 > SURPRISE**2 * (before + noise):
        before = off**2
    share = max(before / (before + noise), LEAST_SHARE)
    return share, share * noise
