"""Which points a leg reaches."""

import numpy as np
import pytest

from legpush.errors import MotionError
from legpush.scene.conventions import JOINTS
from sim_proc.kinematics.reach import require_reach
from tests.robots import KINEMATICS

BELOW = np.array([0.0, 0.5, 1.2])
"""Angles with the foot well below the hip."""


def test_points_within_the_joint_range_are_reached() -> None:
    joints = BELOW + 0.1 * np.random.default_rng(0).uniform(-1, 1, (100, 3))
    tips = KINEMATICS.forward(joints, 1.0)
    require_reach(KINEMATICS, "a curve", tips, 1.0, margin_deg=5.0, within_m=np.full(100, 1e-9))


def test_a_point_too_far_away_is_refused_with_its_distance() -> None:
    tips = np.array([[0.0, 0.111, -0.5], [0.0, 0.111, -1.0]])
    with pytest.raises(MotionError, match=r"Expected a curve that the leg follows to 0\.1 m, .* got 0\.32 m"):
        require_reach(KINEMATICS, "a curve", tips, 1.0, margin_deg=1.0, within_m=np.full(2, 0.1))
    require_reach(KINEMATICS, "a curve", tips, 1.0, margin_deg=1.0, within_m=np.full(2, 0.4))


def test_each_point_has_its_own_distance_and_the_error_names_the_one_that_is_exceeded() -> None:
    tips = np.array([[0.0, 0.111, -0.9], [0.0, 0.111, -0.8]])
    require_reach(KINEMATICS, "a curve", tips, 1.0, margin_deg=1.0, within_m=np.array([0.3, 0.2]))
    with pytest.raises(MotionError, match=r"follows to 0\.05 m, .* got 0\.12 m"):
        require_reach(KINEMATICS, "a curve", tips, 1.0, margin_deg=1.0, within_m=np.array([0.3, 0.05]))


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("joint", "limit"), [(0, 0), (0, 1), (1, 1), (2, 0), (2, 1)])
def test_a_joint_nearer_to_its_limit_than_the_margin_is_named(joint: int, limit: int, side: float) -> None:
    joints, near = BELOW.copy(), np.radians(5.0)
    joints[joint] = (KINEMATICS.lower_limits_rad + near, KINEMATICS.upper_limits_rad - near)[limit][joint]
    tips = KINEMATICS.forward(joints, side)[None]
    require_reach(KINEMATICS, "a curve", tips, side, margin_deg=4.99, within_m=np.full(1, 1e-6))
    with pytest.raises(MotionError, match=rf"with 8° left .* got 0\.0\d m, at the limit of {JOINTS[joint]}"):
        require_reach(KINEMATICS, "a curve", tips, side, margin_deg=8.0, within_m=np.full(1, 1e-3))
