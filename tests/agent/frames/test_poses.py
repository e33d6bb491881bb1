"""Planar poses and errors of a box, read out of a world state."""

from math import cos, degrees, hypot, pi, radians, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from agent_proc.frames.poses import BoxError, box_error, box_tilt_rad, pose_error
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.scene.scenario import Goal, PoseDeg
from tests.agent.fake_world import make_scenario, make_state

TRUNK = Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0)

poses = st.builds(Pose2, x_m=st.floats(0.0, 9.0), y_m=st.floats(0.0, 9.0), yaw_rad=st.floats(-3.1, 3.1))


@given(trunk=poses, box=poses)
def test_planar_poses_of_level_bodies_are_what_they_were_made_with(trunk: Pose2, box: Pose2) -> None:
    state = make_state(trunk, box)

    for body, pose in ((state.trunk, trunk), (state.box, box)):
        seen = planar_pose(body)
        assert (seen.x_m, seen.y_m) == (pose.x_m, pose.y_m)
        assert seen.yaw_rad == pytest.approx(pose.yaw_rad)


def test_the_tilt_is_the_angle_to_the_vertical_in_any_direction() -> None:
    state = make_state(TRUNK, TRUNK)
    tilts = [(cos(0.1), sin(0.1), 0.0, 0.0), (cos(0.1), 0.0, -sin(0.1), 0.0), (cos(0.1), 0.0, 0.0, sin(0.1))]

    seen = [box_tilt_rad(replace(state, box=replace(state.box, orientation_wxyz=tilt))) for tilt in tilts]

    assert seen == pytest.approx([0.2, 0.2, 0.0])


@given(box=poses, goal=poses)
def test_an_error_has_no_sign_and_is_none_at_the_goal(box: Pose2, goal: Pose2) -> None:
    error = pose_error(box, goal)

    assert error.position_m == hypot(box.x_m - goal.x_m, box.y_m - goal.y_m)
    assert 0.0 <= error.angle_rad <= pi
    assert error.angle_rad == pytest.approx(pose_error(goal, box).angle_rad)
    assert pose_error(goal, goal) == BoxError(position_m=0.0, angle_rad=0.0)


def test_the_error_of_a_box_is_against_the_goal_of_its_scenario() -> None:
    scenario = make_scenario(goal=Goal(pose=PoseDeg(x_m=7.0, y_m=3.0, yaw_deg=179.0)))

    error = box_error(make_state(TRUNK, Pose2(x_m=7.3, y_m=3.4, yaw_rad=radians(-179.0))), scenario)

    assert error.position_m == pytest.approx(0.5)
    assert degrees(error.angle_rad) == pytest.approx(2.0)
    assert str(error) == "0.500 m, 2.0°"


@pytest.mark.parametrize(
    ("position_m", "angle_deg", "within"), [(0.03, 2.9, True), (0.031, 0.0, False), (0.0, 3.1, False)]
)
def test_both_parts_have_to_be_inside_the_tolerances(position_m: float, angle_deg: float, within: bool) -> None:
    goal = Goal(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0), position_tolerance_m=0.03, angle_tolerance_deg=3.0)

    assert BoxError(position_m=position_m, angle_rad=radians(angle_deg)).within(goal) is within
