"""The Spot-like robot as bodies of a MuJoCo model, built from boxes, capsules and spheres."""

from math import sin
from typing import Final

from legpush.scene.conventions import JOINTS, LEGS
from legpush.scene.robot import RobotSpec
from sim_proc.headless import mujoco
from sim_proc.kinematics.leg import LegKinematics
from sim_proc.model.collisions import LOWER_LEG, ROBOT

BODYWORK: Final = (0.93, 0.72, 0.11, 1.0)
DARK: Final = (0.13, 0.14, 0.16, 1.0)
ANKLE_SHARE: Final = 1.5
"""Where the capsule of the lower leg ends above the centre of the foot, in radii of the foot.

If it ended in the centre, it would touch the floor with the foot.
"""


def add_robot(spec: mujoco.MjSpec, robot: RobotSpec) -> None:
    """Add the free body `trunk` with its four legs, their joints and their position servos."""
    half = [side / 2 for side in robot.trunk.size_m]
    trunk = spec.worldbody.add_body(name="trunk", pos=[0, 0, 0.5])
    trunk.add_freejoint(name="trunk")
    trunk.add_geom(
        name="trunk",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=half,
        mass=0.0,
        rgba=BODYWORK,
        **ROBOT,
    )
    trunk.explicitinertial = True
    trunk.mass = robot.trunk.mass_kg
    trunk.ipos = [_trunk_com_x_m(robot), 0.0, 0.0]
    x, y, z = robot.trunk.size_m
    trunk.inertia = [robot.trunk.mass_kg / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y))]
    trunk.add_site(name="imu", pos=[0, 0, 0])
    for x, name in ((half[0], "head"), (-half[0], "tail")):
        trunk.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=[x, 0, 0],
            size=[share * side for share, side in zip(robot.trunk.cap_shares, half, strict=True)],
            mass=0.0,
            rgba=DARK,
            **ROBOT,
        )
    for leg in LEGS:
        _add_leg(spec, trunk, leg, robot)


def _trunk_com_x_m(robot: RobotSpec) -> float:
    """Offset of the trunk's own centre of mass along x, body frame.

    The knees point backward, so the legs' mass lies behind the hips. The trunk's mass sits forward to make up for it:
    the standing robot's CoM is then over the origin of the body frame, as in the paper.
    """
    legs = robot.legs
    _, hip_y, knee = LegKinematics(robot).standing_joints_rad()[0]
    upper_x = -legs.upper_length_m / 2 * sin(hip_y)
    lower_x = -legs.upper_length_m * sin(hip_y) - legs.lower_length_m / 2 * sin(hip_y - knee)
    return float(-len(LEGS) * (legs.upper_mass_kg * upper_x + legs.lower_mass_kg * lower_x) / robot.trunk.mass_kg)


def _add_leg(spec: mujoco.MjSpec, trunk: mujoco.MjsBody, leg: str, robot: RobotSpec) -> None:
    legs = robot.legs
    fore = 1.0 if leg.startswith("F") else -1.0
    side = 1.0 if leg.endswith("L") else -1.0
    axes = {"hip_x": [1, 0, 0], "hip_y": [0, 1, 0], "knee": [0, -1, 0]}
    hip = trunk.add_body(name=f"{leg}_hip", pos=[fore * legs.hip_x_m, side * legs.hip_y_m, 0])
    upper = hip.add_body(name=f"{leg}_upper", pos=[0, side * legs.hip_offset_m, 0])
    lower = upper.add_body(name=f"{leg}_lower", pos=[0, 0, -legs.upper_length_m])
    for joint, numbers, body in zip(JOINTS, robot.joints.in_order(), (hip, upper, lower), strict=True):
        body.add_joint(
            name=f"{leg}_{joint}",
            axis=axes[joint],
            range=numbers.limits_rad,
            limited=True,
            armature=numbers.armature_kg_m2,
            damping=numbers.damping_n_m_s_rad,
        )
        actuator = spec.add_actuator(name=f"{leg}_{joint}", target=f"{leg}_{joint}", trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_position(kp=numbers.position_gain_n_m_rad, kv=numbers.velocity_gain_n_m_s_rad)
        actuator.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
        actuator.forcerange = [-numbers.max_torque_n_m, numbers.max_torque_n_m]
    links = [
        (hip, "hip", [0, 0, 0, 0, side * legs.hip_offset_m, 0], legs.hip_radius_m, legs.hip_mass_kg, DARK),
        (upper, "upper", [0, 0, 0, 0, 0, -legs.upper_length_m], legs.upper_radius_m, legs.upper_mass_kg, BODYWORK),
        (
            lower,
            "lower",
            [0, 0, 0, 0, 0, ANKLE_SHARE * legs.foot_radius_m - legs.lower_length_m],
            legs.lower_radius_m,
            legs.lower_mass_kg,
            DARK,
        ),
    ]
    for body, part, fromto, radius, mass, rgba in links:
        body.add_geom(
            name=f"{leg}_{part}",
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=fromto,
            size=[radius, 0, 0],
            mass=mass,
            rgba=rgba,
            **(LOWER_LEG if body is lower else ROBOT),
        )
    lower.add_geom(
        name=f"{leg}_foot",
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        pos=[0, 0, -legs.lower_length_m],
        size=[legs.foot_radius_m, 0, 0],
        mass=0.0,
        rgba=(0.85, 0.24, 0.18, 1.0) if leg.startswith("F") else DARK,
        **LOWER_LEG,
    )
    lower.add_site(name=f"{leg}_tip", pos=[0, 0, -legs.lower_length_m])
