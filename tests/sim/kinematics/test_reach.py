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
    require_reach(KINEMATICS, "the curve", KINEMATICS.forward(joints, 1.0), 1.0, 5.0)


def test_a_point_too_far_away_is_refused_with_its_distance() -> None:
    tips = np.array([[0.0, 0.111, -0.5], [0.0, 0.111, -1.0]])
    with pytest.raises(MotionError, match=r"Expected the curve within reach of the leg, got a point 0\.3\d m beyond"):
        require_reach(KINEMATICS, "the curve", tips, 1.0, 1.0)


@pytest.mark.parametrize(("joint", "lower"), [(0, True), (0, False), (1, False), (2, True), (2, False)])
def test_a_joint_near_its_limit_is_refused_by_name(joint: int, lower: bool) -> None:
    joints, near = BELOW.copy(), np.radians(2.0)
    limits = KINEMATICS.lower_limits_rad + near, KINEMATICS.upper_limits_rad - near
    joints[joint] = limits[0 if lower else 1][joint]
    tips = KINEMATICS.forward(joints, -1.0)[None]
    require_reach(KINEMATICS, "the curve", tips, -1.0, 1.9)
    with pytest.raises(MotionError, match=rf"at least 2\.1° away from .*, got 2\.0° at {JOINTS[joint]}"):
        require_reach(KINEMATICS, "the curve", tips, -1.0, 2.1)
