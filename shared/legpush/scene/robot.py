"""The robot's names and dimensions, defined once for planner, simulator and agent.

Legs are ordered FL, FR, RL, RR and joints hip-x, hip-y, knee everywhere. Dimensions are Spot's public ones; the foot
rectangle and the joint limits (Table 1) are the paper's.
"""

from math import hypot, radians
from typing import Final, Literal

import numpy as np

from legpush.arrays import Floats

Leg = Literal["FL", "FR", "RL", "RR"]
FrontLeg = Literal["FL", "FR"]

LEGS: Final[tuple[Leg, ...]] = ("FL", "FR", "RL", "RR")
FRONT_LEGS: Final[tuple[FrontLeg, ...]] = ("FL", "FR")
JOINTS: Final = ("hip_x", "hip_y", "knee")

CONTROL_PERIOD_S: Final = 0.02
"""One tick: the period at which the simulator commands the joints and records the state."""

FOOT_RECTANGLE_LENGTH_M: Final = 0.5963
FOOT_RECTANGLE_WIDTH_M: Final = 0.3346
"""Nominal stance: the four feet at the corners of this rectangle about the trunk's ground projection."""
FOOT_RECTANGLE_RADIUS_M: Final = hypot(FOOT_RECTANGLE_LENGTH_M, FOOT_RECTANGLE_WIDTH_M) / 2
BODY_LENGTH_M: Final = 0.76
BODY_WIDTH_M: Final = 0.44
"""The floor that trunk and stance cover, about the trunk's ground projection."""
PUSH_GAP_M: Final = 0.12
"""Distance from the front feet to the rear face of the box when the robot stands ready to push."""

HIP_X_M: Final = 0.298
HIP_Y_M: Final = 0.055
L1_M: Final = 0.111
"""Hip offset: distance from the hip-x axis to the leg plane."""
L2_M: Final = 0.3205
"""Length of the upper leg."""
L3_M: Final = 0.37
"""Length of the lower leg, to the centre of the foot sphere."""
FOOT_RADIUS_M: Final = 0.02

JOINT_LIMITS_RAD: Final[dict[str, tuple[float, float]]] = {
    "hip_x": (radians(-45.0), radians(45.0)),
    "hip_y": (radians(-80.0), radians(100.0)),
    "knee": (radians(15.0), radians(130.0)),
}
"""Table 1; the knee angle is flexion, and 0 is the straight leg."""


def foot_rectangle_b() -> Floats:
    """Return the corners of the foot rectangle in the ground-projected body frame, (4, 2), in the order of `LEGS`."""
    half_length, half_width = FOOT_RECTANGLE_LENGTH_M / 2, FOOT_RECTANGLE_WIDTH_M / 2
    return np.array(
        [
            [half_length, half_width],
            [half_length, -half_width],
            [-half_length, half_width],
            [-half_length, -half_width],
        ]
    )


TRUNK_QPOS: Final = slice(0, 7)
JOINT_QPOS: Final = slice(7, 19)
BOX_QPOS: Final = slice(19, 26)
N_QPOS: Final = BOX_QPOS.stop
"""Columns of MuJoCo's `qpos`: position and quaternion (w, x, y, z) of trunk and box, world frame; joints between."""
