"""What can touch what."""

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.scene.conventions import JOINT_QPOS
from legpush.scene.scenario import Rectangle, Room, Scenario
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
