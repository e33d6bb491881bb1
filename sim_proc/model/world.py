"""The world as a MuJoCo model: the Spot-like robot built from primitives, the box, and what touches what.

Masses: 31.84 kg, Spot's public figure of about 32 kg, with 18 kg in the trunk and, per leg, 1.2 kg hip, 1.7 kg upper
and 0.56 kg lower leg. Only the listed contact pairs collide, so that each friction coefficient is stated once.
"""

from collections.abc import Sequence
from math import sin
from typing import Final

import mujoco
import numpy as np
from numpy.typing import NDArray

from legpush.scene.robot import (
    FOOT_RADIUS_M,
    HIP_X_M,
    HIP_Y_M,
    JOINT_LIMITS_RAD,
    JOINTS,
    L1_M,
    L2_M,
    L3_M,
    LEGS,
    foot_rectangle_b,
)
from legpush.scene.scenario import Room, Scenario
from sim_proc.gravity import gravity_m_s2
from sim_proc.kinematics.leg import HIPS_B, SIDE, inverse
from sim_proc.model.box_body import add_box
from sim_proc.model.scenery import add_scenery, wall_name

PHYSICS_STEP_S: Final = 0.002
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
FOOT_FLOOR_FRICTION: Final = 1.0
WALL_FRICTION: Final = 0.5
NET_FORCE: Final = 3
"""How MuJoCo's contact sensor reduces several contacts to one."""

BODYWORK: Final = (0.93, 0.72, 0.11, 1.0)
DARK: Final = (0.13, 0.14, 0.16, 1.0)


def standing_joints_rad() -> NDArray[np.float64]:
    """Joint angles of the nominal stance, feet at the corners of the foot rectangle, (4, 3)."""
    tips_b = np.zeros((4, 3))
    tips_b[:, :2] = foot_rectangle_b()
    tips_b[:, 2] = FOOT_RADIUS_M - STANDING_HEIGHT_M
    return inverse(tips_b - HIPS_B, SIDE)


def build_model(scenario: Scenario) -> mujoco.MjModel:
    """Compile the model of a scenario; the state it starts in is set by whoever simulates it."""
    return build_spec(scenario).compile()


def model_xml(scenario: Scenario) -> str:
    """The model of a scenario as MJCF, for people and other programs; numbers are rounded there."""
    spec = build_spec(scenario)
    spec.compile()
    xml: str = spec.to_xml()
    return xml


def build_spec(scenario: Scenario) -> mujoco.MjSpec:
    """What the model of a scenario consists of."""
    spec = mujoco.MjSpec()
    spec.modelname = "legpush"
    _set_options(spec, scenario.room)
    add_scenery(spec, scenario)
    _add_robot(spec)
    box_geoms = add_box(spec, scenario.box)
    _add_contact_pairs(spec, scenario, box_geoms)
    _add_sensors(spec)
    return spec


def _set_options(spec: mujoco.MjSpec, room: Room) -> None:
    """2 ms, implicit-in-velocity integration, elliptic friction cone.

    With a pyramidal cone friction depends on direction, by a quarter, and so a pushed box on its heading in the room.
    """
    spec.option.timestep = PHYSICS_STEP_S
    spec.option.gravity[:] = gravity_m_s2(room)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.iterations = 50
    spec.option.ls_iterations = 30
    spec.compiler.degree = False


def _add_robot(spec: mujoco.MjSpec) -> None:
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
    """Where the trunk's own mass sits, so that the standing robot's CoM is over the body frame, as in the paper.

    The knees point backward, and the legs' mass lies behind the hips.
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


def _add_contact_pairs(spec: mujoco.MjSpec, scenario: Scenario, box_geoms: Sequence[str]) -> None:
    def pair(first: str, second: str, friction: float) -> None:
        coefficients = [friction, friction, 0.005, 0.0001, 0.0001]
        spec.add_pair(name=f"{first}:{second}", geomname1=first, geomname2=second, friction=coefficients, condim=3)

    box_friction = scenario.box.friction
    feet = [f"{leg}_foot" for leg in LEGS]
    for foot in feet:
        pair("floor", foot, FOOT_FLOOR_FRICTION)
        for box in box_geoms:
            pair(foot, box, box_friction)
    for box in box_geoms:
        pair("floor", box, box_friction)
        for part in ("FL_lower", "FR_lower", "trunk"):
            pair(part, box, box_friction)
    for index in range(len(scenario.room.obstacles)):
        for part in (*feet, "trunk", *box_geoms):
            pair(wall_name(index), part, WALL_FRICTION)


def _add_sensors(spec: mujoco.MjSpec) -> None:
    def contact_force(name: str, foot: str, other: str, kind: mujoco.mjtObj) -> None:
        """Net force of a geom or body on a foot; MuJoCo's contact sensor with data `force` and reduction `netforce`."""
        spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_GEOM,
            objname=foot,
            reftype=kind,
            refname=other,
            intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE), NET_FORCE, 1],
        )

    for leg in LEGS:
        contact_force(f"{leg}_floor_force", f"{leg}_foot", "floor", mujoco.mjtObj.mjOBJ_GEOM)
    for leg in LEGS:
        contact_force(f"{leg}_box_force", f"{leg}_foot", "box", mujoco.mjtObj.mjOBJ_BODY)
    imu = {"objtype": mujoco.mjtObj.mjOBJ_SITE, "objname": "imu"}
    spec.add_sensor(name="imu_orientation", type=mujoco.mjtSensor.mjSENS_FRAMEQUAT, **imu)
    spec.add_sensor(name="imu_angular_velocity", type=mujoco.mjtSensor.mjSENS_GYRO, **imu)
    spec.add_sensor(name="imu_acceleration", type=mujoco.mjtSensor.mjSENS_ACCELEROMETER, **imu)
    spec.add_sensor(
        name="com", type=mujoco.mjtSensor.mjSENS_SUBTREECOM, objtype=mujoco.mjtObj.mjOBJ_BODY, objname="trunk"
    )


def leg_joint_names() -> list[str]:
    """FL_hip_x, FL_hip_y, ... RR_knee."""
    return [f"{leg}_{joint}" for leg in LEGS for joint in JOINTS]
