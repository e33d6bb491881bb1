"""Torques, speeds, powers and angles of the joints over the physics steps of a motion."""

from dataclasses import dataclass

import numpy as np

from legpush.arrays import Floats, Integers
from legpush.messages.measures import TORQUE_BINS
from legpush.scene.conventions import JOINTS, LEGS
from legpush.scene.robot import RobotSpec
from sim_proc.kinematics.actuator_limits import ActuatorLimits
from sim_proc.model.world import PHYSICS_STEP_S


@dataclass(frozen=True, kw_only=True)
class JointMeasures:
    """Measures of the twelve joints."""

    max_torques_n_m: Floats
    max_speeds_rad_s: Floats
    max_powers_w: Floats
    """Largest magnitudes, (12,) each."""
    n_at_limit: Integers
    """Number of steps at the limit of torque, (12,)."""
    least_to_limits_rad: Floats
    """Least distance from the nearer end of the range, negative beyond it, (12,)."""
    torque_counts: Integers
    """How often each kind of joint had a torque, in hundredths of its largest one, (3, TORQUE_BINS)."""
    positive_work_j: float
    """Work of all servos while their power was positive."""


class JointMeter:
    """Measures the joints of one robot."""

    def __init__(self, robot: RobotSpec) -> None:
        self._limits = ActuatorLimits(robot)
        self._ends = np.array([joint.limits_rad for joint in robot.joints.in_order()] * len(LEGS)).T
        kinds = np.tile(np.arange(len(JOINTS)), len(LEGS))
        self._first_bins = kinds[:, None] * TORQUE_BINS
        self._bins_per_n_m = TORQUE_BINS / self._limits.peak_n_m[:, None]

    def measure(self, positions_rad: Floats, speeds_rad_s: Floats, torques_n_m: Floats) -> JointMeasures:
        """Measure n physics steps, (n, 12) each."""
        # Joint by joint, since NumPy is slow at extremes over rows of twelve numbers.
        angles, speeds, torques = (np.ascontiguousarray(rows.T) for rows in (positions_rad, speeds_rad_s, torques_n_m))
        powers, magnitudes = torques * speeds, np.abs(torques)
        low, high = self._ends
        bins = (magnitudes * self._bins_per_n_m).astype(np.intp)
        np.minimum(bins, TORQUE_BINS - 1, out=bins)
        bins += self._first_bins
        counts = np.bincount(bins.ravel(), minlength=len(JOINTS) * TORQUE_BINS)
        return JointMeasures(
            max_torques_n_m=magnitudes.max(axis=1),
            max_speeds_rad_s=np.abs(speeds).max(axis=1),
            max_powers_w=np.abs(powers).max(axis=1),
            n_at_limit=np.count_nonzero(self._limits.reached(angles.T, speeds.T, torques.T), axis=0),
            least_to_limits_rad=np.minimum(angles.min(axis=1) - low, high - angles.max(axis=1)),
            torque_counts=counts.reshape(len(JOINTS), TORQUE_BINS),
            positive_work_j=float(np.maximum(powers, 0.0).sum()) * PHYSICS_STEP_S,
        )
