"""The compiled model against the tables that it is built from."""

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scene.robot import BOX_QPOS, JOINT_LIMITS_RAD, JOINT_QPOS, JOINTS, LEGS, TRUNK_QPOS
from legpush.scene.scenario import Rectangle, Room, Scenario
from sim_proc.kinematics.body import LEG_JOINTS
from sim_proc.model.world import build_model
from sim_proc.physics.physics import Physics


def test_joints_and_actuators_come_in_the_order_of_the_legs(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    assert [model.joint(i).name for i in range(model.njnt)] == ["trunk", *LEG_JOINTS, "box"]
    assert [model.actuator(i).name for i in range(model.nu)] == list(LEG_JOINTS)
    assert model.joint("trunk").qposadr[0] == TRUNK_QPOS.start
    assert model.joint("FL_hip_x").qposadr[0] == JOINT_QPOS.start
    assert model.joint("box").qposadr[0] == BOX_QPOS.start


def test_joint_limits_are_those_of_table_1(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    for leg in LEGS:
        for joint in JOINTS:
            np.testing.assert_allclose(model.joint(f"{leg}_{joint}").range, JOINT_LIMITS_RAD[joint])
    degrees = {joint: np.degrees(limits).round().tolist() for joint, limits in JOINT_LIMITS_RAD.items()}
    assert degrees == {"hip_x": [-45, 45], "hip_y": [-80, 100], "knee": [15, 130]}


def test_the_robot_weighs_what_its_links_weigh_and_stands_with_its_com_over_the_body_frame(
    at_the_box: Scenario,
) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    assert physics.mass_kg == pytest.approx(31.84)
    np.testing.assert_allclose(physics.com_m()[:2], physics.trunk_pose().xy(), atol=1e-3)


def test_the_box_has_the_mass_size_and_friction_of_the_scenario(at_the_box: Scenario) -> None:
    box = replace(at_the_box.box, mass_kg=0.7, friction=0.35, size_m=(0.3, 0.6, 0.5))
    model = build_model(replace(at_the_box, box=box))
    assert model.body("box").mass[0] == pytest.approx(0.7)
    np.testing.assert_allclose(2 * model.geom("box").size, (0.3, 0.6, 0.5))
    for name in ("floor:box", "FL_foot:box"):
        assert model.pair(name).friction[0] == 0.35
    assert model.pair("floor:FL_foot").friction[0] == 1.0


def test_every_obstacle_of_the_room_is_a_wall_that_feet_trunk_and_box_touch(at_the_box: Scenario) -> None:
    walls = (
        Rectangle(x_min_m=4.0, x_max_m=4.5, y_min_m=0.0, y_max_m=3.0),
        Rectangle(x_min_m=7.0, x_max_m=9.0, y_min_m=6.0, y_max_m=6.2),
    )
    model = build_model(replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=walls)))
    for index, wall in enumerate(walls):
        geom = model.geom(f"wall_{index}")
        low, high = geom.pos - geom.size, geom.pos + geom.size
        np.testing.assert_allclose(low[:2], [wall.x_min_m, wall.y_min_m])
        np.testing.assert_allclose(high[:2], [wall.x_max_m, wall.y_max_m])
        pairs = {model.pair(i).name for i in range(model.npair)}
        assert {f"wall_{index}:{part}" for part in ("trunk", "box", "FL_foot", "RR_foot")} <= pairs


def test_the_foot_sensors_of_a_standing_robot_read_its_weight(at_the_box: Scenario) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    targets = np.repeat(physics.data.qpos[JOINT_QPOS][None], 100, axis=0)
    log = physics.run(targets, np.zeros_like(targets))
    vertical = log.floor_forces_n[-1, :, 2]
    assert (vertical > 0).all()
    assert vertical.sum() == pytest.approx(physics.mass_kg * 9.81, rel=0.01)
    np.testing.assert_allclose(physics.sensor("imu_acceleration"), [0.0, 0.0, 9.81], atol=0.2)


def test_mujoco_is_the_version_that_the_numbers_were_measured_with() -> None:
    assert mujoco.__version__.startswith("4.")
