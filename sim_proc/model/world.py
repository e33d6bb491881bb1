"""The MuJoCo model of a scenario: the robot, the box and the room, which of them collide, and the sensors.

Every link of the robot collides with floor, walls and box, and its lower legs collide with each other. Each friction
coefficient is stated once: of listed pairs of geoms, and of walls for whatever touches them.
"""

from collections.abc import Sequence
from typing import Final

from legpush.realism.reality import AS_ASSUMED, Reality
from legpush.scene.conventions import LEGS
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Room, Scenario
from sim_proc.gravity import gravity_m_s2
from sim_proc.headless import mujoco
from sim_proc.model.actual import GROUND, actual_robot, add_tiles, burden
from sim_proc.model.box_body import add_box
from sim_proc.model.collisions import FOOT_SOLREF, ROLLING_FRICTION_M, SOLREF, TURNING_FRICTION_M
from sim_proc.model.robot_body import add_robot
from sim_proc.model.scenery import add_scenery
from sim_proc.model.sensors import add_sensors

PHYSICS_STEP_S: Final = 0.002
JOINT_QVEL: Final = slice(6, 18)
"""Columns of the joints in `qvel`."""


def build_model(scenario: Scenario, reality: Reality = AS_ASSUMED) -> mujoco.MjModel:
    """Compile the model of a scenario, as it is in an episode, or else as the robot takes it to be.

    Its `qpos0` is not where a mission starts: the simulator sets the poses.
    """
    return build_spec(scenario, reality).compile()


def model_xml(scenario: Scenario, reality: Reality = AS_ASSUMED) -> str:
    """The same model as MJCF, for people and other programs. MJCF rounds its numbers.

    Readers of MJCF other than MuJoCo may end at a body that cannot move, and may know no mass of geoms. So robot and
    box come before the scenery, and each body with a joint states its inertia. Joints and actuators have the order of
    the simulated model.
    """
    spec = _build_spec(scenario, reality, movable_first=True)
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


def build_spec(scenario: Scenario, reality: Reality = AS_ASSUMED) -> mujoco.MjSpec:
    """The uncompiled model of a scenario."""
    return _build_spec(scenario, reality, movable_first=False)


def _build_spec(scenario: Scenario, reality: Reality, *, movable_first: bool) -> mujoco.MjSpec:
    """The uncompiled model, with robot and box before or behind the scenery. Their place decides about rounding."""
    spec = mujoco.MjSpec()
    spec.modelname = "legpush"
    robot = actual_robot(scenario.robot, reality)
    _set_options(spec, scenario.room, reality)
    has_tiles = reality.tile_height_m > 0.0
    if not movable_first:
        add_scenery(spec, scenario, ground=GROUND if has_tiles else None)
    add_robot(spec, robot)
    burden(spec, reality)
    box_geoms = add_box(spec, scenario.box)
    if movable_first:
        add_scenery(spec, scenario, ground=GROUND if has_tiles else None)
    floors = ("floor", *(add_tiles(spec.body(GROUND), scenario, reality) if has_tiles else ()))
    _add_contact_pairs(spec, robot, scenario.box, box_geoms, floors)
    add_sensors(spec, ground=GROUND if has_tiles else None)
    return spec


def _set_options(spec: mujoco.MjSpec, room: Room, reality: Reality) -> None:
    """Set 2 ms steps, implicit-in-velocity integration and an elliptic friction cone.

    With a pyramidal cone friction would differ by a quarter between directions, and a pushed box would move differently
    depending on its heading in the room.
    """
    spec.option.timestep = PHYSICS_STEP_S
    spec.option.gravity[:] = gravity_m_s2(room, reality.slope_deg, reality.uphill_deg)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.iterations = 50
    spec.option.ls_iterations = 30
    spec.compiler.degree = False


def _add_contact_pairs(
    spec: mujoco.MjSpec, robot: RobotSpec, of_box: Box, box_geoms: Sequence[str], floors: Sequence[str]
) -> None:
    """Add the pairs of geoms whose contacts are meant, with their friction. Those of feet and tiles are not listed."""

    def pair(first: str, second: str, friction: float, solref: tuple[float, float] = SOLREF) -> None:
        coefficients = [friction, friction, TURNING_FRICTION_M, ROLLING_FRICTION_M, ROLLING_FRICTION_M]
        spec.add_pair(
            name=f"{first}:{second}", geomname1=first, geomname2=second, friction=coefficients, condim=3, solref=solref
        )

    for leg in LEGS:
        pair("floor", f"{leg}_foot", robot.legs.foot_friction, FOOT_SOLREF)
        for box in box_geoms:
            pair(f"{leg}_foot", box, of_box.friction_with_robot)
    for box in box_geoms:
        for floor in floors:
            pair(floor, box, of_box.friction)
        for part in ("FL_lower", "FR_lower", "trunk"):
            pair(part, box, of_box.friction_with_robot)
