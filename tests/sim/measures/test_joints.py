"""Measures of the joints, against numbers computed one by one."""

import numpy as np
import pytest

from legpush.messages.measures import TORQUE_BINS
from sim_proc.kinematics.actuator_limits import ActuatorLimits
from sim_proc.measures.joints import JointMeter
from tests.robots import ROBOT

LIMITS = ActuatorLimits(ROBOT)
RANGES = [joint.limits_rad for joint in ROBOT.joints.in_order()] * 4


def test_extremes_and_work_are_those_of_each_joint() -> None:
    rng = np.random.default_rng(3)
    low, high = np.array(RANGES).T
    positions = rng.uniform(low, high, (200, 12))
    speeds, torques = rng.normal(0.0, 3.0, (200, 12)), rng.normal(0.0, 10.0, (200, 12))
    seen = JointMeter(ROBOT).measure(positions, speeds, torques)
    for joint in range(12):
        angle, speed, torque = positions[:, joint], speeds[:, joint], torques[:, joint]
        assert seen.max_torques_n_m[joint] == max(abs(each) for each in torque)
        assert seen.max_speeds_rad_s[joint] == max(abs(each) for each in speed)
        assert seen.max_powers_w[joint] == max(abs(a * b) for a, b in zip(torque, speed, strict=True))
        assert seen.least_to_limits_rad[joint] == min(min(q - low[joint], high[joint] - q) for q in angle)
    work = sum(max(torque * speed, 0.0) * 0.002 for torque, speed in zip(torques.ravel(), speeds.ravel(), strict=True))
    assert seen.positive_work_j == pytest.approx(work)


def test_a_joint_beyond_its_range_has_a_negative_distance() -> None:
    positions = np.zeros((1, 12))
    positions[0, 2] = RANGES[2][0] - 0.1
    seen = JointMeter(ROBOT).measure(positions, np.zeros((1, 12)), np.zeros((1, 12)))
    assert seen.least_to_limits_rad[2] == pytest.approx(-0.1)


def test_a_servo_is_at_its_limit_where_it_has_no_more_torque() -> None:
    positions, speeds = np.tile(np.radians([0.0, 0.0, 60.0]), (3, 4)), np.zeros((3, 12))
    speeds[1] = 5.0
    lower, upper = LIMITS.bounds_n_m(positions, speeds)
    torques = np.stack([0.999 * upper[0], upper[1], lower[2]])
    seen = JointMeter(ROBOT).measure(positions, speeds, torques)
    assert seen.n_at_limit.tolist() == [2] * 12


def test_torques_are_counted_in_hundredths_of_the_largest_one() -> None:
    torques = np.zeros((2, 12))
    torques[0], torques[1, ::3] = -LIMITS.peak_n_m, 0.255 * LIMITS.peak_n_m[0]
    seen = JointMeter(ROBOT).measure(np.zeros((2, 12)), np.zeros((2, 12)), torques)
    assert seen.torque_counts.shape == (3, TORQUE_BINS)
    assert seen.torque_counts.sum(axis=1).tolist() == [8, 8, 8]
    assert (seen.torque_counts[0, 25], seen.torque_counts[0, 99]) == (4, 4)
    assert (seen.torque_counts[1, 0], seen.torque_counts[2, 99]) == (4, 4)
