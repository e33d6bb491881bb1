"""Names, orders and columns agree with one another."""

from legpush.scene.conventions import (
    BOX_QPOS,
    FRONT_LEGS,
    JOINT_QPOS,
    JOINTS,
    LEG_JOINTS,
    LEGS,
    N_QPOS,
    TRUNK_QPOS,
)


def test_the_front_legs_are_the_first_legs() -> None:
    assert LEGS[:2] == FRONT_LEGS
    assert all(leg[0] == "F" for leg in FRONT_LEGS)


def test_qpos_has_trunk_joints_and_box_one_after_the_other() -> None:
    columns = [index for part in (TRUNK_QPOS, JOINT_QPOS, BOX_QPOS) for index in range(26)[part]]
    assert columns == list(range(N_QPOS))
    assert len(range(26)[JOINT_QPOS]) == len(LEGS) * len(JOINTS)


def test_joints_are_named_leg_by_leg() -> None:
    assert len(LEG_JOINTS) == len(set(LEG_JOINTS)) == 12
    assert LEG_JOINTS[:3] == ("FL_hip_x", "FL_hip_y", "FL_knee")
    assert LEG_JOINTS[-1] == "RR_knee"
