"""Terms in the frame of the goal: the mirror, bounds, and what each reads."""

from math import radians

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from agent_proc.frames.push_view import LOOK_AHEAD_M, PushView, push_view
from agent_proc.task.file import load_task
from agent_proc.task.observation.goal_frame import BoxPlace, BoxYaw, Heading, HeadingNear
from agent_proc.task.observed import observation_bounds
from agent_proc.task.observed import observe as observe_task
from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.scenario import Goal, PoseDeg, Scenario
from legpush.scene.station import station
from tests.agent.fake_world import make_scenario, make_state
from tests.robots import ROBOT

SCENARIO = make_scenario()
"""The goal is at (7, 3), heading along x."""

TASK = load_task("tuned", SCENARIO)

box_poses = st.builds(
    Pose2, x_m=st.floats(5.0, 8.0), y_m=st.floats(2.0, 4.0), yaw_rad=st.floats(-radians(60.0), radians(60.0))
)
trunk_offsets = st.builds(Pose2, x_m=st.floats(-0.05, 0.05), y_m=st.floats(-0.05, 0.05), yaw_rad=st.floats(-0.1, 0.1))


def view_of(box: Pose2, offset: Pose2, scenario: Scenario = SCENARIO) -> PushView:
    return push_view(make_state(station(ROBOT, SCENARIO.box, box) @ offset, box), scenario)


def observe(view: PushView) -> Floats:
    return np.concatenate([term.read(view, view.mirror_sign) for term in TASK.observation_terms.values()])


def mirrored(pose: Pose2, line_y_m: float) -> Pose2:
    return Pose2(x_m=pose.x_m, y_m=2 * line_y_m - pose.y_m, yaw_rad=-pose.yaw_rad)


def named(observation: Floats) -> dict[str, Floats]:
    terms = TASK.observation_terms
    ends = np.cumsum([len(term.AXES) for term in terms.values()])
    return dict(zip(terms, np.split(observation, ends[:-1]), strict=True))


@given(box=box_poses, offset=trunk_offsets)
def test_mirror_images_look_the_same(box: Pose2, offset: Pose2) -> None:
    view = view_of(box, offset)
    image = view_of(mirrored(box, 3.0), mirrored(offset, 0.0))

    if view.mirror_sign != image.mirror_sign:
        np.testing.assert_allclose(observe(view), observe(image), atol=1e-9)
    else:
        np.testing.assert_allclose(box.y_m + 0.2 * np.sin(box.yaw_rad), 3.0, atol=1e-8)


@given(box=box_poses, offset=trunk_offsets, turn=st.floats(-180.0, 180.0), shift=st.floats(-1.0, 1.0))
def test_the_place_of_the_goal_in_the_room_does_not_show(box: Pose2, offset: Pose2, turn: float, shift: float) -> None:
    moved_from_world = Pose2(x_m=shift, y_m=2 * shift, yaw_rad=radians(turn))
    goal = moved_from_world @ SCENARIO.goal.pose.pose()
    elsewhere = make_scenario(goal=Goal(pose=PoseDeg(x_m=goal.x_m, y_m=goal.y_m, yaw_deg=np.degrees(goal.yaw_rad))))
    moved = view_of(moved_from_world @ box, offset, elsewhere)

    if abs(box.y_m + 0.2 * np.sin(box.yaw_rad) - 3.0) > 1e-6:
        np.testing.assert_allclose(observe(moved), observe(view_of(box, offset)), atol=1e-9)


@given(box=box_poses, offset=trunk_offsets)
def test_the_bounds_hold_every_observation(box: Pose2, offset: Pose2) -> None:
    low, high = observation_bounds(TASK)
    observation = observe_task(TASK, view_of(box, offset))

    assert low.shape == high.shape == observation.shape == (8,)
    assert ((low <= observation) & (observation <= high)).all()


def test_each_entry_reads_what_its_name_says() -> None:
    box = Pose2(x_m=6.0, y_m=3.2, yaw_rad=0.1)
    left = named(observe(view_of(box, Pose2(x_m=0.01, y_m=0.02, yaw_rad=0.03))))

    np.testing.assert_allclose(left["box"], [-1.0, 0.2])
    np.testing.assert_allclose(left["box_near"], np.arcsinh([-20.0, 4.0]))
    np.testing.assert_allclose(left["heading"], [0.1, 0.1 + np.arctan2(0.2, LOOK_AHEAD_M)])
    np.testing.assert_allclose(left["heading_near"], np.arcsinh(left["heading"] / radians(1.0)))


def test_a_box_far_short_of_its_goal_is_observed_as_far_as_the_profile_goes() -> None:
    ahead = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    far, farther = (observe(view_of(Pose2(x_m=x, y_m=3.1, yaw_rad=0.0), ahead)) for x in (5.9, 5.0))

    np.testing.assert_allclose(far, farther, atol=1e-12)


def test_settings_say_how_far_is_far_and_how_near_is_near() -> None:
    view = view_of(Pose2(x_m=5.0, y_m=3.1, yaw_rad=0.1), Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0))

    np.testing.assert_allclose(BoxPlace(far_m=3.0).read(view, 1.0), [-2.0, 0.1])
    heading = Heading().read(view, 1.0)
    np.testing.assert_allclose(HeadingNear(near_deg=2.0).read(view, 1.0), np.arcsinh(heading / radians(2.0)))
    np.testing.assert_array_equal(BoxYaw().read(view, -1.0), -heading[:1])


def test_a_task_that_is_not_mirrored_reads_right_of_the_line_as_it_is() -> None:
    plain = load_task("tuned", SCENARIO, mirrored=False)
    right = view_of(Pose2(x_m=6.0, y_m=2.9, yaw_rad=0.0), Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0))

    assert [observe_task(task, right)[1] for task in (plain, TASK)] == [np.float32(-0.1), np.float32(0.1)]
