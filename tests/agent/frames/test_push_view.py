"""The view of a box and its goal: what it derives, how often, and from which face."""

from math import atan2, cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from agent_proc.frames import push_view as module
from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import LOOK_AHEAD_M, PushView, push_view, pushed_state
from legpush.arrays import Floats
from legpush.geometry import Pose2, rotation_from_rpy, rpy_from_quaternion, wrap_angle
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import BoxState
from legpush.scene.faces import FACES, TURN_RAD, pushed_pose
from legpush.scene.scenario import Face, Goal, PoseDeg
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()
"""The goal is at (7, 3), heading along x."""
TRUNK = Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0)

boxes = st.builds(Pose2, x_m=st.floats(4.0, 8.0), y_m=st.floats(2.0, 4.0), yaw_rad=st.floats(-pi, pi))


def view_of(box: Pose2) -> PushView:
    return push_view(make_state(TRUNK, box), SCENARIO)


@given(box=boxes, x_m=st.floats(4.0, 8.0), y_m=st.floats(2.0, 4.0), yaw_deg=st.floats(-360.0, 360.0))
def test_the_box_in_the_frame_of_its_goal_leads_back_to_the_box(
    box: Pose2, x_m: float, y_m: float, yaw_deg: float
) -> None:
    scenario = make_scenario(goal=Goal(pose=PoseDeg(x_m=x_m, y_m=y_m, yaw_deg=yaw_deg)))

    view = push_view(make_state(TRUNK, box), scenario)

    again = scenario.goal.pose.pose() @ view.box_g
    np.testing.assert_allclose([again.x_m, again.y_m], [box.x_m, box.y_m], atol=1e-9)
    assert wrap_angle(again.yaw_rad - box.yaw_rad) == pytest.approx(0.0, abs=1e-9)


def test_x_is_minus_the_distance_that_remains() -> None:
    view = view_of(Pose2(x_m=6.2, y_m=3.1, yaw_rad=0.2))

    assert (view.box_g.x_m, view.box_g.y_m, view.box_g.yaw_rad) == pytest.approx((-0.8, 0.1, 0.2))


def test_the_steering_error_is_against_the_heading_to_the_line_ahead() -> None:
    view = view_of(Pose2(x_m=6.0, y_m=3.1, yaw_rad=0.2))

    assert view.steering_error_rad == pytest.approx(0.2 + atan2(0.1, LOOK_AHEAD_M))


@pytest.mark.parametrize(
    ("y_m", "yaw_deg", "sign"),
    [(3.1, 0.0, 1.0), (2.9, 0.0, -1.0), (3.0, 0.0, 1.0), (3.0 - 1e-11, 0.0, 1.0), (3.02, -10.0, -1.0), (2.98, 10.0, 1)],
)
def test_the_front_edge_of_the_box_decides_whether_the_mirror_image_is_looked_at(
    y_m: float, yaw_deg: float, sign: float
) -> None:
    assert view_of(Pose2(x_m=6.0, y_m=y_m, yaw_rad=radians(yaw_deg))).mirror_sign == sign


@given(box=boxes)
def test_the_error_is_that_of_the_box_in_its_scenario(box: Pose2) -> None:
    view = view_of(box)

    assert view.error == box_error(view.world, SCENARIO)


def test_a_view_knows_whether_the_robot_has_fallen() -> None:
    box = Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.0)

    assert [push_view(make_state(TRUNK, box, fallen=fallen), SCENARIO).fallen for fallen in (False, True)] == [
        False,
        True,
    ]


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[Goal]:
    """The goals in whose frames a box has been computed."""
    goals: list[Goal] = []
    compute = module.box_in_goal_frame

    def count(box_w: Pose2, goal: Goal) -> Pose2:
        goals.append(goal)
        return compute(box_w, goal)

    monkeypatch.setattr(module, "box_in_goal_frame", count)
    return goals


def test_everything_that_needs_the_box_in_the_frame_of_its_goal_shares_it(counted: list[Goal]) -> None:
    view = view_of(Pose2(x_m=6.0, y_m=2.9, yaw_rad=0.1))
    n_before = len(counted)

    for _ in range(2):
        assert (view.box_g, view.steering_error_rad, view.mirror_sign, view.error) is not None

    assert (n_before, counted) == (0, [SCENARIO.goal])


def rotation_of(box: BoxState) -> Floats:
    return rotation_from_rpy(*rpy_from_quaternion(box.orientation_wxyz))


@pytest.mark.parametrize("face", FACES)
def test_the_pushed_frame_of_a_face_has_it_at_the_rear(face: Face) -> None:
    state = make_state(TRUNK, Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.4))

    seen = planar_pose(pushed_state(state.box, face))

    expected = pushed_pose(planar_pose(state.box), face)
    assert (seen.x_m, seen.y_m) == (expected.x_m, expected.y_m)
    assert wrap_angle(seen.yaw_rad - expected.yaw_rad) == pytest.approx(0.0)


@pytest.mark.parametrize("face", FACES)
def test_the_pushed_frame_of_a_box_that_leans_is_turned_about_the_box_s_own_axis(face: Face) -> None:
    leaning = replace(make_state(TRUNK, TRUNK).box, orientation_wxyz=(cos(0.05), sin(0.05), 0.0, 0.0))

    seen = pushed_state(leaning, face)

    about_z = rotation_from_rpy(0.0, 0.0, TURN_RAD[face])
    np.testing.assert_allclose(rotation_of(seen), rotation_of(leaning) @ about_z, atol=1e-12)
    assert seen.position_m == leaning.position_m
