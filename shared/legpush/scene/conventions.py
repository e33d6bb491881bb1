"""Conventions that planner, simulator and agent share: legs and joints in their order, columns of `qpos`, the tick.

They hold for every robot; the numbers of one robot are in `legpush.scene.robot`.
"""

from typing import Final, Literal

Leg = Literal["FL", "FR", "RL", "RR"]
FrontLeg = Literal["FL", "FR"]

LEGS: Final[tuple[Leg, ...]] = ("FL", "FR", "RL", "RR")
"""Front left, front right, rear left, rear right: the order of the legs everywhere."""
FRONT_LEGS: Final[tuple[FrontLeg, ...]] = ("FL", "FR")
JOINTS: Final = ("hip_x", "hip_y", "knee")
"""The joints of a leg in their order."""
LEG_JOINTS: Final = tuple(f"{leg}_{joint}" for leg in LEGS for joint in JOINTS)
"""Names of the twelve joints in the order of `qpos`: FL_hip_x, FL_hip_y, ... RR_knee."""

CONTROL_PERIOD_S: Final = 0.02
"""One tick: the period at which the simulator commands the joints and records the state."""
GRAVITY_M_S2: Final = 9.81
LOADED_N: Final = 1.0
"""A foot with at least this vertical force touches the floor."""

TRUNK_QPOS: Final = slice(0, 7)
JOINT_QPOS: Final = slice(7, 19)
BOX_QPOS: Final = slice(19, 26)
N_QPOS: Final = BOX_QPOS.stop
"""Columns of MuJoCo's `qpos`: position and quaternion (w, x, y, z) of trunk and box, world frame; joints between."""
