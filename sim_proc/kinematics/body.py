"""The robot's body in numbers: standing pose, masses and servo gains."""

from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.robot import FOOT_RADIUS_M, JOINTS, LEGS, foot_rectangle_b
from sim_proc.kinematics.leg import HIPS_B, SIDE, inverse

LOADED_N = 1.0
"""A foot with at least this vertical force counts as standing."""


STANDING_HEIGHT_M: Final = 0.48
"""Trunk centre above the floor."""
TRUNK_HALF_SIZE_M: Final = (0.35, 0.11, 0.085)
TRUNK_MASS_KG: Final = 18.0
HIP_MASS_KG: Final = 1.2
UPPER_MASS_KG: Final = 1.7
LOWER_MASS_KG: Final = 0.56
POSITION_GAIN_N_M_RAD: Final = 1000.0
VELOCITY_GAIN_N_M_S_RAD: Final = 30.0
ARMATURE_KG_M2: Final = 0.02
DAMPING_N_M_S_RAD: Final = 0.5


def standing_joints_rad() -> Floats:
    """Joint angles of the nominal stance, feet at the corners of the foot rectangle, (4, 3)."""
    tips_b = np.zeros((4, 3))
    tips_b[:, :2] = foot_rectangle_b()
    tips_b[:, 2] = FOOT_RADIUS_M - STANDING_HEIGHT_M
    return inverse(tips_b - HIPS_B, SIDE)


def leg_joint_names() -> list[str]:
    """FL_hip_x, FL_hip_y, ... RR_knee."""
    return [f"{leg}_{joint}" for leg in LEGS for joint in JOINTS]
