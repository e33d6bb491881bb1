"""The bodies of the robot against the tables that they are built from."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scene.conventions import JOINTS, LEG_JOINTS, LEGS
from legpush.scene.scenario import Scenario
from sim_proc.model.world import build_model
from sim_proc.physics.physics import Physics
from tests.robots import ROBOT


def test_joint_limits_are_those_of_table_1(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    for leg in LEGS:
        degrees = {joint: np.degrees(model.joint(f"{leg}_{joint}").range).round().tolist() for joint in JOINTS}
        assert degrees == {"hip_x": [-45, 45], "hip_y": [-80, 100], "knee": [15, 130]}


def test_the_robot_weighs_what_its_links_weigh_and_stands_with_its_com_over_the_body_frame(
    at_the_box: Scenario,
) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    assert physics.mass_kg == pytest.approx(31.84)
    np.testing.assert_allclose(physics.com_m()[:2], physics.trunk_pose().xy(), atol=1e-3)


def test_every_joint_has_the_servo_and_the_damping_of_the_table(at_the_box: Scenario) -> None:
    knee = replace(ROBOT.joints.knee, position_gain_n_m_rad=700.0, velocity_gain_n_m_s_rad=20.0, max_torque_n_m=60.0)
    robot = replace(ROBOT, joints=replace(ROBOT.joints, knee=knee))
    model = build_model(replace(at_the_box, robot=robot))
    for name, joint in zip(LEG_JOINTS, len(LEGS) * robot.joints.in_order(), strict=True):
        servo = model.actuator(name)
        kp, kv, torque = joint.position_gain_n_m_rad, joint.velocity_gain_n_m_s_rad, joint.max_torque_n_m
        assert servo.gainprm[0] == kp
        np.testing.assert_allclose(servo.biasprm[1:3], [-kp, -kv])
        assert servo.forcelimited[0] == (torque is not None)
        np.testing.assert_allclose(servo.forcerange, [-(torque or 0.0), torque or 0.0])
        assert model.joint(name).damping[0] == joint.damping_n_m_s_rad
        assert model.joint(name).armature[0] == joint.armature_kg_m2


def test_a_tip_is_the_centre_of_its_foot(at_the_box: Scenario) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    feet = [physics.data.geom(f"{leg}_foot") for leg in LEGS]
    np.testing.assert_allclose(physics.tips_m(), [foot.xpos for foot in feet], atol=1e-12)
    assert {float(physics.model.geom(foot.name).size[0]) for foot in feet} == {ROBOT.legs.foot_radius_m}
