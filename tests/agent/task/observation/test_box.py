"""Terms of what is known of the box: its sides as the robot sees them, and what its pushes have shown."""

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import push_view
from agent_proc.push_model.estimate import FeltBox, PushEstimate
from agent_proc.task.file import load_task
from agent_proc.task.observation.box import BoxSides, LostDepth, PushDrift, PushEffect
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scenarios.file import load_scenario
from tests.agent.fake_world import make_state

SCENARIO = load_scenario("open")
STATE = make_state(SCENARIO.start.pose(), SCENARIO.box.pose.pose())
PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)
START = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)


def test_sides_are_those_along_and_across_the_pushing_direction() -> None:
    seen = {face: BoxSides().read(push_view(STATE, SCENARIO, face=face), 1.0).tolist() for face in ("rear", "left")}
    assert seen == {"rear": [0.4, 0.5], "left": [0.5, 0.4]}


def test_a_drift_is_what_pushes_do_beyond_the_model_and_has_a_mirror_image() -> None:
    estimate = PushEstimate(SCENARIO.box)
    expected = estimate.after(START, PUSH)
    beyond = Pose2(x_m=0.001, y_m=-0.004, yaw_rad=0.02)
    for _ in range(10):
        after = Pose2(
            x_m=expected.x_m + beyond.x_m, y_m=expected.y_m + beyond.y_m, yaw_rad=expected.yaw_rad + beyond.yaw_rad
        )
        estimate.learn(START, PUSH, after)
    view = push_view(STATE, SCENARIO, estimate.felt)

    assert PushDrift().read(view, 1.0) == pytest.approx([0.001, -0.004, 0.02], abs=1e-4)
    assert PushDrift().read(view, -1.0) == pytest.approx([0.001, 0.004, -0.02], abs=1e-4)
    assert LostDepth().read(view, 1.0).tolist() == [estimate.lost_depth_m]


def test_an_effect_is_what_the_fit_says_of_both_legs_and_a_mirror_image_swaps_them() -> None:
    estimate = PushEstimate(SCENARIO.box)
    for _ in range(20):
        for leg, turn_rad in (("FL", -0.02), ("FR", 0.09)):
            estimate.learn(START, replace(PUSH, leg=leg), Pose2(x_m=0.03, y_m=0.0, yaw_rad=turn_rad))
    view = push_view(STATE, SCENARIO, estimate.felt)
    assert view.response.lost_depth_m == pytest.approx(0.0075, abs=0.0026)

    usual_m = 0.05 - view.response.lost_depth_m
    per_metre = np.array([0.03, 0.03, -0.02, -0.09]) / usual_m
    assert PushEffect().read(view, 1.0) == pytest.approx(0.05 * per_metre, rel=0.1)
    assert PushEffect().read(view, -1.0).tolist() == PushEffect().read(view, 1.0)[[1, 0, 3, 2]].tolist()


def test_before_the_first_push_an_effect_is_what_is_expected_of_such_a_box() -> None:
    forward, other_forward, turn, other_turn = PushEffect().read(push_view(STATE, SCENARIO), 1.0)
    after = PushEstimate(SCENARIO.box).after(START, PUSH)
    assert (forward, turn) == (other_forward, other_turn) == pytest.approx((after.x_m, after.yaw_rad))


def test_the_last_pushes_count_most_for_the_drift() -> None:
    estimate = PushEstimate(SCENARIO.box)
    for aside_m in (0.0, 0.0, 0.0, 0.01, 0.01, 0.01):
        at = estimate.after(START, PUSH)
        estimate.learn(START, PUSH, replace(at, y_m=at.y_m + aside_m))
    assert 0.006 < estimate.drift[1] < 0.01


def test_nothing_is_drift_before_the_first_push() -> None:
    assert PushEstimate(SCENARIO.box).drift == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("name", "feels"), [("tuned", False), ("push-l1", False), ("push-l2", True), ("push-l3", True)]
)
def test_a_task_that_observes_what_pushes_have_shown_says_so(name: str, feels: bool) -> None:
    assert load_task(name).feels_box is feels


@pytest.mark.parametrize("term", [BoxSides(), LostDepth(), PushDrift()])
def test_what_is_read_is_within_its_limits(term: BoxSides | LostDepth | PushDrift) -> None:
    view = push_view(STATE, SCENARIO, FeltBox(lost_depth_m=0.03, drift=(0.01, -0.02, 0.3)))
    low, high = term.limits(SCENARIO)
    assert (np.asarray(low) <= term.read(view, 1.0)).all()
    assert (term.read(view, 1.0) <= np.asarray(high)).all()
