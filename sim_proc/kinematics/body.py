"""The robot's body in numbers: standing pose, masses, servo gains and joint names.

The robot weighs 31.84 kg; Spot's public figure is about 32 kg.
"""

from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.robot import FOOT_RADIUS_M, JOINTS, LEGS, foot_rectangle_b
from sim_proc.kinematics.leg import HIPS_B, SIDE, inverse

LEG_JOINTS: Final = tuple(f"{leg}_{joint}" for leg in LEGS for joint in JOINTS)
"""Names of the twelve joints in the order of `qpos`: FL_hip_x, FL_hip_y, ... RR_knee."""

STANDING_HEIGHT_M: Final = 0.48
"""Height of the trunk's centre above the floor."""
LOADED_N: Final = 1.0
"""A foot with at least this vertical force counts as standing."""

TRUNK_HALF_SIZE_M: Final = (0.35, 0.11, 0.085)
"""Half of length, width and height."""
TRUNK_MASS_KG: Final = 18.0
HIP_MASS_KG: Final = 1.2
UPPER_MASS_KG: Final = 1.7
LOWER_MASS_KG: Final = 0.56
"""Masses of hip, upper leg and lower leg, each of them four times."""

POSITION_GAIN_N_M_RAD: Final = 1000.0
VELOCITY_GAIN_N_M_S_RAD: Final = 30.0
"""Gains of the position servo of each joint."""
ARMATURE_KG_M2: Final = 0.02
DAMPING_N_M_S_RAD: Final = 0.5
"""Rotor inertia and viscous damping of each joint."""


def standing_joints_rad() -> Floats:
    """Joint angles of the nominal stance, feet at the corners of the foot rectangle, (4, 3)."""
    tips_b = np.zeros((4, 3))
    tips_b[:, :2] = foot_rectangle_b()
    tips_b[:, 2] = FOOT_RADIUS_M - STANDING_HEIGHT_M
    return inverse(tips_b - HIPS_B, SIDE)
