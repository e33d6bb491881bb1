"""Planar poses compose, invert and apply; rotations agree with one another."""

from math import atan2, cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.geometry import Pose2, rectangle_corners, rotation_from_rpy, rpy_from_quaternion, wrap_angle

ANGLE = st.floats(-3.1, 3.1)
POSE = st.builds(Pose2, x_m=st.floats(-5.0, 5.0), y_m=st.floats(-5.0, 5.0), yaw_rad=ANGLE)
POINTS = np.array([[0.0, 0.0], [1.0, 0.0], [-0.5, 2.0]])


def numbers(pose: Pose2) -> tuple[float, float, float, float]:
    return pose.x_m, pose.y_m, cos(pose.yaw_rad), sin(pose.yaw_rad)


@given(a=POSE, b=POSE)
def test_a_composed_pose_does_one_after_the_other(a: Pose2, b: Pose2) -> None:
    np.testing.assert_allclose((a @ b).apply(POINTS), a.apply(b.apply(POINTS)), atol=1e-12)


@given(pose=POSE)
def test_a_pose_and_its_inverse_are_none(pose: Pose2) -> None:
    for composed in (pose @ pose.inverse(), pose.inverse() @ pose):
        assert numbers(composed) == pytest.approx((0.0, 0.0, 1.0, 0.0), abs=1e-12)


@given(angle_rad=st.floats(-50.0, 50.0))
def test_a_wrapped_angle_is_the_same_angle_between_minus_pi_and_pi(angle_rad: float) -> None:
    wrapped = wrap_angle(angle_rad)
    assert -pi < wrapped <= pi
    assert atan2(sin(wrapped - angle_rad), cos(wrapped - angle_rad)) == pytest.approx(0.0, abs=1e-12)


def test_half_a_turn_is_positive() -> None:
    assert wrap_angle(-pi) == wrap_angle(pi) == pi


def test_corners_come_counter_clockwise_from_front_left() -> None:
    assert rectangle_corners(4.0, 2.0).tolist() == [[2.0, 1.0], [-2.0, 1.0], [-2.0, -1.0], [2.0, -1.0]]


@given(roll=st.floats(-1.5, 1.5), pitch=st.floats(-1.5, 1.5), yaw=ANGLE)
def test_a_quaternion_has_the_angles_that_it_was_made_of(roll: float, pitch: float, yaw: float) -> None:
    (cr, sr), (cp, sp), (cy, sy) = ((cos(a / 2), sin(a / 2)) for a in (roll, pitch, yaw))
    quaternion = [
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ]
    np.testing.assert_allclose(rpy_from_quaternion(quaternion), [roll, pitch, yaw], atol=1e-7)


@given(roll=ANGLE, pitch=ANGLE, yaw=ANGLE)
def test_a_rotation_turns_by_roll_then_pitch_then_yaw(roll: float, pitch: float, yaw: float) -> None:
    rotation = rotation_from_rpy(roll, pitch, yaw)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    by_parts = rotation_from_rpy(0, 0, yaw) @ rotation_from_rpy(0, pitch, 0) @ rotation_from_rpy(roll, 0, 0)
    np.testing.assert_allclose(rotation, by_parts, atol=1e-12)
    np.testing.assert_allclose(rotation_from_rpy(0, 0, pi / 2) @ [1, 0, 0], [0, 1, 0], atol=1e-12)
