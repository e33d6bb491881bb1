"""What can touch what."""

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.scene.conventions import JOINT_QPOS
from legpush.scene.scenario import Rectangle, Room, Scenario
from sim_proc.model import scenery
from sim_proc.model.collisions import WALL_FRICTION
from sim_proc.physics.physics import Physics


def touching(scenario: Scenario, trunk: Pose2, height_m: float, joints_rad: dict[int, float]) -> set[frozenset[str]]:
    """Pairs of geoms that touch when the robot is put somewhere."""
    physics = Physics(scenario, trunk, scenario.box.pose.pose())
    model, data = physics.model, physics.data
    data.qpos[2] = height_m
    for joint, angle in joints_rad.items():
        data.qpos[JOINT_QPOS][joint] = angle
    mujoco.mj_forward(model, data)
    return {frozenset(model.geom(geom).name for geom in pair) for pair in data.contact.geom}


def by_parts(pairs: set[frozenset[str]], other: str) -> set[str]:
    """Parts of the robot that touch something else, without the names of their legs."""
    return {name.rpartition("_")[2] for pair in pairs if other in pair for name in pair - {other}}


def test_every_part_of_a_robot_that_lies_on_the_floor_touches_it(at_the_box: Scenario) -> None:
    pairs = touching(at_the_box, Pose2(x_m=3.0, y_m=2.0, yaw_rad=0.0), 0.05, {})
    assert {"trunk", "hip", "upper", "lower", "foot"} <= by_parts(pairs, "floor")


@pytest.mark.parametrize("side_m", [0.15, -0.15])
def test_a_wall_beside_the_robot_is_touched_by_its_legs(at_the_box: Scenario, side_m: float) -> None:
    low, high = sorted((2.0 + side_m, 2.0 + 10 * side_m))
    wall = Rectangle(x_min_m=1.0, x_max_m=6.0, y_min_m=low, y_max_m=high)
    scenario = replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=(wall,)))
    pairs = touching(scenario, Pose2(x_m=3.0, y_m=2.0, yaw_rad=0.0), 0.48, {})
    assert {"hip", "upper", "lower", "foot"} <= by_parts(pairs, "wall_0")


def test_legs_that_cross_touch_each_other(at_the_box: Scenario) -> None:
    inward = {0: -0.6, 3: 0.6}
    pairs = touching(at_the_box, Pose2(x_m=3.0, y_m=2.0, yaw_rad=0.0), 0.6, inward)
    assert any(names <= {"FL_lower", "FR_lower", "FL_foot", "FR_foot"} for names in pairs)


def test_a_robot_that_stands_touches_the_floor_with_its_feet_alone(at_the_box: Scenario) -> None:
    start = at_the_box.start.pose()
    pairs = touching(at_the_box, start, at_the_box.robot.stance.height_m - 1e-4, {})
    robot = {name for pair in pairs for name in pair if name[:2] in ("FL", "FR", "RL", "RR") or name == "trunk"}
    assert robot == {"FL_foot", "FR_foot", "RL_foot", "RR_foot"}
    assert np.all([not ({"box"} & pair) or "floor" in pair for pair in pairs])


def contacts(scenario: Scenario, trunk: Pose2, box: Pose2, tilt_rad: float = 0.0) -> dict[frozenset[str], set[float]]:
    """Sliding friction coefficients of the geoms that touch, by pair."""
    physics = Physics(scenario, trunk, box)
    data = physics.data
    data.qpos[3:7] = np.cos(tilt_rad / 2), 0.0, np.sin(tilt_rad / 2), 0.0
    mujoco.mj_forward(physics.model, data)
    found: dict[frozenset[str], set[float]] = {}
    for contact in data.contact:
        names = frozenset(physics.model.geom(geom).name for geom in contact.geom)
        found.setdefault(names, set()).add(float(contact.friction[0]))
    return found


def test_whatever_touches_a_wall_has_the_friction_of_walls(at_the_box: Scenario) -> None:
    walls = (
        Rectangle(x_min_m=1.0, x_max_m=6.0, y_min_m=0.0, y_max_m=1.85),
        Rectangle(x_min_m=6.9, x_max_m=8.0, y_min_m=4.0, y_max_m=6.0),
    )
    box = replace(at_the_box.box, friction=0.9, foot_friction=1.1)
    scenario = replace(at_the_box, box=box, room=Room(size_m=(12.0, 10.0), obstacles=walls))
    found = contacts(scenario, Pose2(x_m=3.0, y_m=2.0, yaw_rad=0.0), Pose2(x_m=6.8, y_m=5.0, yaw_rad=0.0))

    by_wall = {index: {pair - {f"wall_{index}"} for pair in found if f"wall_{index}" in pair} for index in (0, 1)}
    assert {"FR_hip", "FR_upper", "FR_lower", "FR_foot"} <= frozenset().union(*by_wall[0])
    assert by_wall[1] == {frozenset({"box"})}
    of_walls = [friction for pair, friction in found.items() if any(name.startswith("wall_") for name in pair)]
    assert set().union(*of_walls) == {WALL_FRICTION}


@pytest.mark.parametrize(("foot_friction", "with_robot"), [(None, 0.9), (0.2, 0.2)])
def test_the_box_has_a_friction_with_the_floor_and_one_with_all_parts_of_the_robot(
    at_the_box: Scenario, foot_friction: float | None, with_robot: float
) -> None:
    box = replace(at_the_box.box, size_m=(0.6, 0.5, 0.45), friction=0.9, foot_friction=foot_friction)
    start, place = at_the_box.start.pose(), Pose2(x_m=2.4, y_m=5.0, yaw_rad=0.0)
    found = contacts(replace(at_the_box, box=box), start, place, tilt_rad=0.3)

    touched = {name: values for pair, values in found.items() if "box" in pair for name in pair - {"box"}}
    assert touched.pop("floor") == {0.9}
    assert {"head", "trunk", "FL_upper", "FL_lower"} <= set(touched)
    assert set().union(*touched.values()) == {with_robot}


@pytest.mark.parametrize("seed", range(5))
def test_the_grouping_of_walls_changes_no_contact(
    at_the_box: Scenario, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    random = np.random.default_rng(seed)
    places = random.uniform(0.0, 12.0, (60, 2)).tolist()
    sizes = random.uniform(0.1, 3.0, (60, 2)).tolist()
    walls = tuple(
        Rectangle(x_min_m=x, x_max_m=x + length, y_min_m=y, y_max_m=y + width)
        for (x, y), (length, width) in zip(places, sizes, strict=True)
    )
    scenario = replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=walls))
    trunk, box = (Pose2(x_m=x, y_m=y, yaw_rad=yaw) for x, y, yaw in random.uniform(0.0, 10.0, (2, 3)).tolist())
    grouped = contacts(scenario, trunk, box)
    monkeypatch.setattr(scenery, "wall_groups", lambda room: {index: (index,) for index in range(len(room.obstacles))})
    assert contacts(scenario, trunk, box) == grouped
    assert any(name.startswith("wall_") for pair in grouped for name in pair)
