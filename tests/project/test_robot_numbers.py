"""Numbers of the robot are in its record alone: no module keeps one of its own, and none assumes the default robot."""

import ast
from collections.abc import Iterator
from pathlib import Path

from tests.project.test_layout import PACKAGES, modules

BODY_AND_MOTION = ("sim_proc/control", "sim_proc/kinematics", "sim_proc/measures", "sim_proc/model", "sim_proc/physics")
"""Folders of the robot's body and motion."""
OF_NO_ROBOT = {
    "control/balance.py": {"JERK_WEIGHT", "END_WEIGHT"},
    "control/feedback/capture.py": {"PAIRS", "BESIDE", "ALONG_SHARE"},
    "control/feedback/deviation.py": {"LATE_TICKS", "CLEAR_SHARE"},
    "control/feedback/footing.py": {"REGAIN_SHARE", "HOLD_TICKS", "IN_AIR_SHARE"},
    "control/feedback/terrain.py": {"ALONG_FROM", "ALONG_UNTIL", "SLOW_TICKS"},
    "control/footsteps.py": {"STRIDE_SHARES", "APART_SHARE", "SAME_M", "ADVANCES"},
    "control/joint_commands.py": {"COMMAND_PERIOD_S"},
    "control/push_cycle.py": {"MIRRORED", "ON_ITS_WAY_RADII", "CURVE"},
    "control/resistance.py": {"GAIN", "STRUCK_TICKS"},
    "control/step_motion.py": {"SHIFT_WEIGHT", "LAST_SHARE", "LIFTED_SHARE", "CAUTION", "TOLD_TICKS"},
    "control/steps.py": {"MOST_AGAIN", "UNLEVELLED"},
    "control/stroke.py": {"RISE_SHARE"},
    "control/swing.py": {"LOCUS_RANGE_RAD", "APEX_SHARE", "SETTLED_SHARE"},
    "kinematics/actuator_limits.py": {"SLACK_N_M"},
    "kinematics/leg.py": {"SIDE", "LEAST_DROP_M", "LARGEST_DIRECTION_RAD"},
    "measures/loads.py": {"LOADED_SHARE", "UNLOADED_SHARE", "FLIGHT_S"},
    "measures/support.py": {"CORNERS"},
    "model/actual.py": {"PAYLOAD_HALF_M", "PAYLOAD_RED", "TILE_GREY", "TILE_DEPTH_M", "LEVEL_M", "LEAST_TILE_M"},
    "model/box_body.py": {"CARDBOARD", "MARK", "MARK_HALF_WIDTH_M", "LOAD_SHARE"},
    "model/collisions.py": {
        "SOLREF",
        "FOOT_SOLREF",
        "WALL_FRICTION",
        "TURNING_FRICTION_M",
        "ROLLING_FRICTION_M",
        "WALL",
    },
    "model/robot_body.py": {"BODYWORK", "DARK", "ANKLE_SHARE"},
    "model/scenery.py": {
        "WALL_GREY",
        "APPEARED_OCHRE",
        "GOAL_GREEN",
        "LEAST_SQUARE_M",
        "SQUARES_ALONG",
        "MOST_ALONE",
        "UNMOVED",
    },
    "model/sensors.py": {"NET_FORCE"},
    "model/shapes.py": {"FLOOR_GREY"},
    "model/world.py": {"PHYSICS_STEP_S", "JOINT_QVEL"},
    "physics/appearing.py": {"CELL_M", "BOX_CLEARANCE_M", "ROUNDING_TICKS", "NEVER"},
    "physics/contacts.py": {"UNKNOWN", "MAX_SETS"},
    "physics/gusts.py": {"NEVER", "ROUNDING_TICKS"},
    "physics/landing.py": {"BLOCKED_SHARE", "STILL_RAD", "LIFTED_SHARE", "SUDDEN_SHARE", "MOST_LATE_TICKS"},
    "physics/physics.py": {"PARKED_M"},
    "physics/senses.py": {"CHUNK_TICKS", "FIRST_CHUNK"},
}
"""Numbers there that hold for every robot: weights, shares, signs, colours, and numbers of box, room and physics."""
MAKE_THE_DEFAULT = {"shared/legpush/scene/scenario.py", "shared/legpush/scenarios/file.py"}
"""Modules that may make the default robot: as the default of a scenario, and to leave its numbers out of a file."""
RECORDS = tuple(f"shared/legpush/scene/{name}.py" for name in ("robot", "robot_body", "robot_motion"))


def assigned_numbers(path: Path) -> Iterator[str]:
    """Names at the top of a module whose values are written with numbers."""
    for node in ast.parse(path.read_text()).body:
        if not isinstance(node, (ast.Assign, ast.AnnAssign)) or node.value is None:
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        constants = [part.value for part in ast.walk(node.value) if isinstance(part, ast.Constant)]
        if any(type(constant) in (int, float) for constant in constants):
            yield from (target.id for target in targets if isinstance(target, ast.Name))


def makes_a_default_robot(path: Path) -> bool:
    """Whether a module calls `RobotSpec` or one of its parts without arguments."""
    parts = (
        "RobotSpec",
        "Trunk",
        "Legs",
        "Joints",
        "Stance",
        "Gait",
        "RoughGait",
        "PushMotion",
        "Capture",
        "FallLimits",
    )
    calls = (node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call))
    return any(isinstance(call.func, ast.Name) and call.func.id in parts and not call.keywords for call in calls)


def test_body_and_motion_have_no_numbers_of_the_robot_beside_its_record(root: Path) -> None:
    found = {
        str(path.relative_to(root / "sim_proc")): names
        for path in modules(root, *BODY_AND_MOTION)
        if (names := set(assigned_numbers(path)))
    }
    assert found == OF_NO_ROBOT


def test_the_records_of_the_robot_have_no_numbers_to_import(root: Path) -> None:
    assert [list(assigned_numbers(root / path)) for path in RECORDS] == [[], [], []]


def test_no_module_assumes_the_default_robot(root: Path) -> None:
    makers = {str(path.relative_to(root)) for path in modules(root, *PACKAGES) if makes_a_default_robot(path)}
    assert makers == {*MAKE_THE_DEFAULT, "shared/legpush/scene/robot.py"}
