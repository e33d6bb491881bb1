"""The robot's names and dimensions agree with one another."""

import numpy as np
import pytest

from legpush.scene import robot


def test_feet_stand_at_the_corners_of_their_rectangle_in_the_order_of_the_legs() -> None:
    feet = dict(zip(robot.LEGS, robot.foot_rectangle_b(), strict=True))
    assert all((x > 0.0) == (leg[0] == "F") and (y > 0.0) == (leg[1] == "L") for leg, (x, y) in feet.items())
    assert {leg for leg in robot.LEGS if leg[0] == "F"} == set(robot.FRONT_LEGS)
    assert np.hypot(*robot.foot_rectangle_b().T) == pytest.approx(robot.FOOT_RECTANGLE_RADIUS_M)


def test_qpos_has_trunk_joints_and_box_one_after_the_other() -> None:
    columns = [index for part in (robot.TRUNK_QPOS, robot.JOINT_QPOS, robot.BOX_QPOS) for index in range(26)[part]]
    assert columns == list(range(robot.N_QPOS))
    assert len(range(26)[robot.JOINT_QPOS]) == len(robot.LEGS) * len(robot.JOINTS)
    assert robot.JOINT_LIMITS_RAD.keys() == set(robot.JOINTS)
