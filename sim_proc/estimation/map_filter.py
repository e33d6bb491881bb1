"""Where the world is in the frame of the robot's own measurements, from noisy fixes of the robot in the world."""

from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.perception import Fix

FIX_VARIANCES: Final = np.array([0.02**2, 0.02**2, np.radians(1.0) ** 2])
"""Of a fix: x and y, [m²], and heading, [rad²], as in the profile `real`."""
WAY_VARIANCES: Final = np.array([0.005**2, 0.005**2, np.radians(0.1) ** 2])
"""What each metre adds by which the robot believes to have moved. Our choice."""
STANDING_VARIANCE: Final = (2e-4) ** 2
"""What each second adds to the heading, [rad²]."""


class MapFilter:
    """A Kalman filter of the robot's pose in the world. Between two fixes the robot's own measurements move it.

    A fix moves the world in the frame of these measurements, and never the robot: its legs do not feel a fix.
    """

    def __init__(self, fix: Fix, odometry: Pose2) -> None:
        """Begin with a fix of the time when the trunk is at `odometry` in the frame of the measurements."""
        self._seen, self._odometry, self._tick = fix.pose, odometry, fix.given_tick
        self._covariance: Floats = np.diag(FIX_VARIANCES)
        self._past_ticks = np.array([fix.given_tick])
        self._past: Floats = np.array([_row(odometry)])
        self.last_tick = fix.tick
        """When the last fix was measured."""
        self.place = odometry @ fix.pose.inverse()
        """Pose of the frame of the world in that of the measurements."""

    def take(self, first_tick: int, odometry: Floats, fixes: list[Fix], latency_ticks: int) -> None:
        """Take the poses of the trunk (n, 3) at the ends of ticks from `first_tick` on, and the fixes given meanwhile.

        Fixes are at most `latency_ticks` old.
        """
        ticks = np.arange(first_tick, first_tick + len(odometry))
        self._past_ticks = np.concatenate([self._past_ticks, ticks])
        self._past = np.concatenate([self._past, odometry])
        for fix in fixes:
            self._correct(fix)
        kept = slice(-latency_ticks - 1, None)
        self._past_ticks, self._past = self._past_ticks[kept], self._past[kept]

    def _correct(self, fix: Fix) -> None:
        then, now = self._at(fix.tick), self._at(fix.given_tick)
        moved = self._odometry.inverse() @ now
        self._seen, self._odometry = self._seen @ moved, now
        turned = self._seen.yaw_rad - moved.yaw_rad
        c, s = np.cos(turned), np.sin(turned)
        transition = np.eye(3)
        transition[0, 2] = -s * moved.x_m - c * moved.y_m
        transition[1, 2] = c * moved.x_m - s * moved.y_m
        way_m = float(np.hypot(moved.x_m, moved.y_m))
        covariance = transition @ self._covariance @ transition.T + np.diag(way_m * WAY_VARIANCES)
        covariance[2, 2] += (fix.given_tick - self._tick) * CONTROL_PERIOD_S * STANDING_VARIANCE
        fixed = fix.pose @ (then.inverse() @ now)
        surprise = np.array(
            [
                fixed.x_m - self._seen.x_m,
                fixed.y_m - self._seen.y_m,
                wrap_angle(fixed.yaw_rad - self._seen.yaw_rad),
            ]
        )
        gain = np.linalg.solve(covariance + np.diag(FIX_VARIANCES), covariance).T
        x, y, yaw = (gain @ surprise).tolist()
        self._seen = Pose2(x_m=self._seen.x_m + x, y_m=self._seen.y_m + y, yaw_rad=wrap_angle(self._seen.yaw_rad + yaw))
        covariance = covariance - gain @ covariance
        self._covariance = (covariance + covariance.T) / 2
        self._tick, self.last_tick = fix.given_tick, fix.tick
        self.place = self._odometry @ self._seen.inverse()

    def _at(self, tick: int) -> Pose2:
        x, y, yaw = self._past[int(np.searchsorted(self._past_ticks, tick))].tolist()
        return Pose2(x_m=x, y_m=y, yaw_rad=yaw)

    def as_bytes(self) -> bytes:
        """All that later places of the world depend on."""
        poses = np.array([_row(self._seen), _row(self._odometry), [self._tick, self.last_tick, 0.0]])
        return poses.tobytes() + self._covariance.tobytes() + self._past.tobytes()


def _row(pose: Pose2) -> list[float]:
    return [pose.x_m, pose.y_m, pose.yaw_rad]
