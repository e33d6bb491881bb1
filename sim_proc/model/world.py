"""The MuJoCo model of a scenario: the robot, the box and the room, which of them collide, and the sensors.

Every link of the robot collides with floor, walls and box, and its lower legs collide with each other. Each friction
coefficient is stated once: of listed pairs of geoms, and of walls for whatever touches them.
"""

from collections.abc import Sequence
from typing import Any, Final

from legpush.scene.conventions import FRONT_LEGS, JOINTS, LEGS
from legpush.scene.scenario import Room, Scenario
from sim_proc.gravity import gravity_m_s2
from sim_proc.headless import mujoco
from sim_proc.model.box_body import add_box
from sim_proc.model.collisions import FOOT_SOLREF, ROLLING_FRICTION_M, SOLREF, TURNING_FRICTION_M
from sim_proc.model.robot_body import add_robot
from sim_proc.model.scenery import add_scenery

PHYSICS_STEP_S: Final = 0.002
JOINT_QVEL: Final = slice(6, 18)
"""Columns of the joints in `qvel`."""
NET_FORCE: Final = 3
"""Reduction `netforce` of MuJoCo's contact sensor: the sum of all contacts as one."""


def build_model(scenario: Scenario) -> mujoco.MjModel:
    """Compile the model of a scenario. Its `qpos0` is not where a mission starts: the simulator sets the poses."""
    return build_spec(scenario).compile()


def model_xml(scenario: Scenario) -> str:
    """The model of a scenario as MJCF, for people and other programs. MJCF rounds its numbers.

    Readers of MJCF other than MuJoCo may end at a body that cannot move, and may know no mass of geoms. So robot and
    box come before the scenery, and each body with a joint states its inertia. Joints and actuators have the order of
    the simulated model.
    """
    spec = _build_spec(scenario, movable_first=True)
    model = spec.compile()
    for body in spec.bodies:
        compiled = model.body(body.name)
        if compiled.jntnum[0]:
            body.explicitinertial = True
            body.mass, body.inertia = compiled.mass[0], compiled.inertia
            body.ipos, body.iquat = compiled.ipos, compiled.iquat
    spec.compile()
    xml: str = spec.to_xml()
    return xml


def build_spec(scenario: Scenario) -> mujoco.MjSpec:
    """The uncompiled model of a scenario."""
    return _build_spec(scenario, movable_first=False)


def _build_spec(scenario: Scenario, *, movable_first: bool) -> mujoco.MjSpec:
    """The uncompiled model, with robot and box before or behind the scenery. Their place decides about rounding."""
    spec = mujoco.MjSpec()
    spec.modelname = "legpush"
    _set_options(spec, scenario.room)
    if not movable_first:
        add_scenery(spec, scenario)
    add_robot(spec, scenario.robot)
    box_geoms = add_box(spec, scenario.box)
    if movable_first:
        add_scenery(spec, scenario)
    _add_contact_pairs(spec, scenario, box_geoms)
    _add_sensors(spec)
    return spec


def _set_options(spec: mujoco.MjSpec, room: Room) -> None:
    """Set 2 ms steps, implicit-in-velocity integration and an elliptic friction cone.

    With a pyramidal cone friction would differ by a quarter between directions, and a pushed box would move differently
    depending on its heading in the room.
    """
    spec.option.timestep = PHYSICS_STEP_S
    spec.option.gravity[:] = gravity_m_s2(room)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.iterations = 50
    spec.option.ls_iterations = 30
    spec.compiler.degree = False


def _add_contact_pairs(spec: mujoco.MjSpec, scenario: Scenario, box_geoms: Sequence[str]) -> None:
    """Add the pairs of geoms whose contacts are meant, with their friction."""

    def pair(first: str, second: str, friction: float, solref: tuple[float, float] = SOLREF) -> None:
        coefficients = [friction, friction, TURNING_FRICTION_M, ROLLING_FRICTION_M, ROLLING_FRICTION_M]
        spec.add_pair(
            name=f"{first}:{second}", geomname1=first, geomname2=second, friction=coefficients, condim=3, solref=solref
        )

    for leg in LEGS:
        pair("floor", f"{leg}_foot", scenario.robot.legs.foot_friction, FOOT_SOLREF)
        for box in box_geoms:
            pair(f"{leg}_foot", box, scenario.box.friction_with_robot)
    for box in box_geoms:
        pair("floor", box, scenario.box.friction)
        for part in ("FL_lower", "FR_lower", "trunk"):
            pair(part, box, scenario.box.friction_with_robot)


def _add_sensors(spec: mujoco.MjSpec) -> None:
    """Add sensors: forces on the feet, an IMU, joints, the robot's centre of mass, and numbers of contacts."""

    def contact_force(name: str, foot: str, other: str, kind: mujoco.mjtObj) -> None:
        """Net force of a geom or body on a foot: MuJoCo's contact sensor with data `force` and reduction `netforce`."""
        spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_GEOM,
            objname=foot,
            reftype=kind,
            refname=other,
            intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE), NET_FORCE, 1],
        )

    def n_contacts(name: str, **between: Any) -> None:
        """The number of contacts, of all or of those between two things."""
        spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND), 0, 1],
            **between,
        )

    for leg in LEGS:
        contact_force(f"{leg}_floor_force", f"{leg}_foot", "floor", mujoco.mjtObj.mjOBJ_GEOM)
    for leg in LEGS:
        contact_force(f"{leg}_box_force", f"{leg}_foot", "box", mujoco.mjtObj.mjOBJ_BODY)
    imu = {"objtype": mujoco.mjtObj.mjOBJ_SITE, "objname": "imu"}
    spec.add_sensor(name="imu_orientation", type=mujoco.mjtSensor.mjSENS_FRAMEQUAT, **imu)
    spec.add_sensor(name="imu_angular_velocity", type=mujoco.mjtSensor.mjSENS_GYRO, **imu)
    spec.add_sensor(name="imu_acceleration", type=mujoco.mjtSensor.mjSENS_ACCELEROMETER, **imu)
    trunk = {"objtype": mujoco.mjtObj.mjOBJ_BODY, "objname": "trunk"}
    spec.add_sensor(name="com_velocity", type=mujoco.mjtSensor.mjSENS_SUBTREELINVEL, **trunk)
    for leg in LEGS:
        tip = {"objtype": mujoco.mjtObj.mjOBJ_SITE, "objname": f"{leg}_tip"}
        spec.add_sensor(name=f"{leg}_tip", type=mujoco.mjtSensor.mjSENS_FRAMEPOS, **tip)
    joints = [f"{leg}_{joint}" for leg in LEGS for joint in JOINTS]
    for what, kind, sensed in (
        ("position", mujoco.mjtSensor.mjSENS_JOINTPOS, mujoco.mjtObj.mjOBJ_JOINT),
        ("velocity", mujoco.mjtSensor.mjSENS_JOINTVEL, mujoco.mjtObj.mjOBJ_JOINT),
        ("torque", mujoco.mjtSensor.mjSENS_ACTUATORFRC, mujoco.mjtObj.mjOBJ_ACTUATOR),
    ):
        for name in joints:
            spec.add_sensor(name=f"{name}_{what}", type=kind, objtype=sensed, objname=name)
    spec.add_sensor(
        name="com", type=mujoco.mjtSensor.mjSENS_SUBTREECOM, objtype=mujoco.mjtObj.mjOBJ_BODY, objname="trunk"
    )
    for leg in LEGS:
        spec.add_sensor(
            name=f"{leg}_foot_force",
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_GEOM,
            objname=f"{leg}_foot",
            intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE), NET_FORCE, 1],
        )
    box, floor = (
        {"objtype": mujoco.mjtObj.mjOBJ_BODY, "objname": "box"},
        {"reftype": mujoco.mjtObj.mjOBJ_GEOM, "refname": "floor"},
    )
    for leg in LEGS:
        n_contacts(f"{leg}_floor_contacts", objtype=mujoco.mjtObj.mjOBJ_GEOM, objname=f"{leg}_foot", **floor)
    n_contacts("box_floor_contacts", **box, **floor)
    for leg in FRONT_LEGS:
        foot = {"reftype": mujoco.mjtObj.mjOBJ_GEOM, "refname": f"{leg}_foot"}
        n_contacts(f"{leg}_box_contacts", **box, **foot)
    n_contacts("contacts")
