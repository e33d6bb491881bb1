"""What the actuators of the legs can do at each angle and speed of their joints."""

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.conventions import LEGS
from legpush.scene.robot import RobotSpec

SLACK_N_M = 1e-9
"""Rounding of a torque at its limit."""


class ActuatorLimits:
    """Largest torques of the twelve joints of one robot. Many rows are fastest in column-major order, joint by joint.

    A joint that moves the way its torque acts has less torque the faster it moves: all of it at rest, and none at its
    largest speed. A knee is driven by a linkage, so its torque depends on its angle as well.
    """

    def __init__(self, robot: RobotSpec) -> None:
        joints = robot.joints.in_order()
        self.peak_n_m: Floats = np.array(len(LEGS) * [joint.max_torque_n_m for joint in joints])
        """Largest torques at rest and at the best angle, (12,)."""
        self._slope = self.peak_n_m / np.array(len(LEGS) * [joint.max_speed_rad_s for joint in joints])
        self._by_angle = []
        """Joints whose torque depends on their angle, angles, and torques there."""
        for index, joint in enumerate(joints):
            if joint.torque_by_angle:
                angles_deg, torques_n_m = np.array(joint.torque_by_angle).T
                self._by_angle.append((slice(index, None, len(joints)), np.radians(angles_deg), torques_n_m))

    def bounds_n_m(self, positions_rad: Floats, speeds_rad_s: Floats) -> tuple[Floats, Floats]:
        """Least and largest torques at joint angles and speeds (..., 12)."""
        peak = np.empty_like(positions_rad)
        peak[:] = self.peak_n_m
        for joints, angles_rad, torques_n_m in self._by_angle:
            there = np.interp(positions_rad[..., joints], angles_rad, torques_n_m)
            np.minimum(peak[..., joints], there, out=peak[..., joints])
        lost = self._slope * speeds_rad_s
        upper = np.minimum(peak, np.maximum(self.peak_n_m - lost, 0.0))
        lower = -np.minimum(peak, np.maximum(self.peak_n_m + lost, 0.0))
        return lower, upper

    def beyond(self, positions_rad: Floats, speeds_rad_s: Floats, torques_n_m: Floats) -> Flags:
        """Whether torques (..., 12) are more than the actuators have."""
        lower, upper = self.bounds_n_m(positions_rad, speeds_rad_s)
        flags: Flags = (torques_n_m > upper + SLACK_N_M) | (torques_n_m < lower - SLACK_N_M)
        return flags

    def reached(self, positions_rad: Floats, speeds_rad_s: Floats, torques_n_m: Floats) -> Flags:
        """Whether torques (..., 12) are all that the actuators have."""
        lower, upper = self.bounds_n_m(positions_rad, speeds_rad_s)
        flags: Flags = (torques_n_m >= upper - SLACK_N_M) | (torques_n_m <= lower + SLACK_N_M)
        return flags
