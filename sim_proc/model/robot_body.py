"""The Spot-like robot as bodies of a MuJoCo model, built from boxes, capsules and spheres."""

from math import sin
from typing import Final

from legpush.scene.robot import FOOT_RADIUS_M, HIP_X_M, HIP_Y_M, JOINT_LIMITS_RAD, JOINTS, L1_M, L2_M, L3_M, LEGS
from sim_proc.headless import mujoco
from sim_proc.kinematics.body import (
    ARMATURE_KG_M2,
    DAMPING_N_M_S_RAD,
    HIP_MASS_KG,
    LOWER_MASS_KG,
    POSITION_GAIN_N_M_RAD,
    TRUNK_HALF_SIZE_M,
    TRUNK_MASS_KG,
    UPPER_MASS_KG,
    VELOCITY_GAIN_N_M_S_RAD,
    standing_joints_rad,
)

BODYWORK: Final = (0.93, 0.72, 0.11, 1.0)
DARK: Final = (0.13, 0.14, 0.16, 1.0)


def add_robot(spec: mujoco.MjSpec) -> None:
    """Add the free body `trunk` with its four legs, their joints and their position servos."""
    trunk = spec.worldbody.add_body(name="trunk", pos=[0, 0, 0.5])
    trunk.add_freejoint(name="trunk")
    trunk.add_geom(
        name="trunk",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=TRUNK_HALF_SIZE_M,
        mass=0.0,
        rgba=BODYWORK,
        contype=0,
        conaffinity=0,
    )
    trunk.explicitinertial = True
    trunk.mass = TRUNK_MASS_KG
    trunk.ipos = [_trunk_com_x_m(), 0.0, 0.0]
    x, y, z = (2 * half for half in TRUNK_HALF_SIZE_M)
    trunk.inertia = [TRUNK_MASS_KG / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y))]
    trunk.add_site(name="imu", pos=[0, 0, 0])
    for x, name in ((TRUNK_HALF_SIZE_M[0], "head"), (-TRUNK_HALF_SIZE_M[0], "tail")):
        trunk.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=[x, 0, 0],
            size=[0.012, 0.095, 0.07],
            mass=0.0,
            rgba=DARK,
            contype=0,
            conaffinity=0,
        )
    for leg in LEGS:
        _add_leg(spec, trunk, leg)


def _trunk_com_x_m() -> float:
    """Offset of the trunk's own centre of mass along x, body frame.

    The knees point backward, so the legs' mass lies behind the hips. The trunk's mass sits forward to make up for it:
    the standing robot's CoM is then over the origin of the body frame, as in the paper.
    """
    _, hip_y, knee = standing_joints_rad()[0]
    upper_x = -L2_M / 2 * sin(hip_y)
    lower_x = -L2_M * sin(hip_y) - L3_M / 2 * sin(hip_y - knee)
    return float(-len(LEGS) * (UPPER_MASS_KG * upper_x + LOWER_MASS_KG * lower_x) / TRUNK_MASS_KG)


def _add_leg(spec: mujoco.MjSpec, trunk: mujoco.MjsBody, leg: str) -> None:
    fore = 1.0 if leg.startswith("F") else -1.0
    side = 1.0 if leg.endswith("L") else -1.0
    axes = {"hip_x": [1, 0, 0], "hip_y": [0, 1, 0], "knee": [0, -1, 0]}
    hip = trunk.add_body(name=f"{leg}_hip", pos=[fore * HIP_X_M, side * HIP_Y_M, 0])
    upper = hip.add_body(name=f"{leg}_upper", pos=[0, side * L1_M, 0])
    lower = upper.add_body(name=f"{leg}_lower", pos=[0, 0, -L2_M])
    for joint, body in zip(JOINTS, (hip, upper, lower), strict=True):
        low, high = JOINT_LIMITS_RAD[joint]
        body.add_joint(
            name=f"{leg}_{joint}",
            axis=axes[joint],
            range=[low, high],
            limited=True,
            armature=ARMATURE_KG_M2,
            damping=DAMPING_N_M_S_RAD,
        )
        actuator = spec.add_actuator(name=f"{leg}_{joint}", target=f"{leg}_{joint}", trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_position(kp=POSITION_GAIN_N_M_RAD, kv=VELOCITY_GAIN_N_M_S_RAD)
    links = [
        (hip, "hip", [0, 0, 0, 0, side * L1_M, 0], 0.055, HIP_MASS_KG, DARK),
        (upper, "upper", [0, 0, 0, 0, 0, -L2_M], 0.04, UPPER_MASS_KG, BODYWORK),
        (lower, "lower", [0, 0, 0, 0, 0, -L3_M], 0.018, LOWER_MASS_KG, DARK),
    ]
    for body, part, fromto, radius, mass, rgba in links:
        body.add_geom(
            name=f"{leg}_{part}",
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=fromto,
            size=[radius, 0, 0],
            mass=mass,
            rgba=rgba,
            contype=0,
            conaffinity=0,
        )
    lower.add_geom(
        name=f"{leg}_foot",
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        pos=[0, 0, -L3_M],
        size=[FOOT_RADIUS_M, 0, 0],
        mass=0.0,
        rgba=(0.85, 0.24, 0.18, 1.0) if leg.startswith("F") else DARK,
        contype=0,
        conaffinity=0,
    )
    lower.add_site(name=f"{leg}_tip", pos=[0, 0, -L3_M])
