"""The bodies of the robot against the tables that they are built from."""

import numpy as np
import pytest

from legpush.scene.robot import FOOT_RADIUS_M, JOINT_LIMITS_RAD, JOINTS, LEGS
from legpush.scene.scenario import Scenario
from sim_proc.kinematics.body import DAMPING_N_M_S_RAD, LEG_JOINTS, POSITION_GAIN_N_M_RAD, VELOCITY_GAIN_N_M_S_RAD
from sim_proc.model.world import build_model
from sim_proc.physics.physics import Physics


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


def test_every_joint_has_the_servo_and_the_damping_of_the_table(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    for name in LEG_JOINTS:
        servo = model.actuator(name)
        assert servo.gainprm[0] == POSITION_GAIN_N_M_RAD
        np.testing.assert_allclose(servo.biasprm[1:3], [-POSITION_GAIN_N_M_RAD, -VELOCITY_GAIN_N_M_S_RAD])
        assert model.joint(name).damping[0] == DAMPING_N_M_S_RAD


def test_a_tip_is_the_centre_of_its_foot(at_the_box: Scenario) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    feet = [physics.data.geom(f"{leg}_foot") for leg in LEGS]
    np.testing.assert_allclose(physics.tips_m(), [foot.xpos for foot in feet], atol=1e-12)
    assert {float(physics.model.geom(foot.name).size[0]) for foot in feet} == {FOOT_RADIUS_M}
