"""The numbers of the robot's body."""

import numpy as np
import pytest

from legpush.scene.robot import FOOT_RADIUS_M, foot_rectangle_b
from sim_proc.kinematics.body import (
    HIP_MASS_KG,
    LEG_JOINTS,
    LOWER_MASS_KG,
    STANDING_HEIGHT_M,
    TRUNK_MASS_KG,
    UPPER_MASS_KG,
    standing_joints_rad,
)
from sim_proc.kinematics.leg import HIPS_B, LOWER_LIMITS, SIDE, UPPER_LIMITS, forward


def test_the_robot_stands_with_its_feet_on_the_floor_at_the_corners_of_the_rectangle() -> None:
    joints = standing_joints_rad()
    tips = HIPS_B + forward(joints, SIDE)
    np.testing.assert_allclose(tips[:, :2], foot_rectangle_b(), atol=1e-12)
    np.testing.assert_allclose(tips[:, 2] + STANDING_HEIGHT_M, FOOT_RADIUS_M)
    assert ((joints > LOWER_LIMITS) & (joints < UPPER_LIMITS)).all()


def test_the_robot_weighs_as_much_as_spot() -> None:
    mass_kg = TRUNK_MASS_KG + 4 * (HIP_MASS_KG + UPPER_MASS_KG + LOWER_MASS_KG)
    assert mass_kg == pytest.approx(31.84)


def test_joints_are_named_leg_by_leg() -> None:
    assert len(LEG_JOINTS) == len(set(LEG_JOINTS)) == 12
    assert LEG_JOINTS[:3] == ("FL_hip_x", "FL_hip_y", "FL_knee")
    assert LEG_JOINTS[-1] == "RR_knee"
