"""The policy of the value table in worlds that follow a response it does not know at first."""

from math import degrees, hypot, radians

import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import push_view
from agent_proc.policies.dynamic_programming.policy import FIRST_M, DynamicProgramming
from agent_proc.policies.registry import make_policy, policy_from_data
from agent_proc.push_model.estimate import FeltBox, PushEstimate
from agent_proc.push_model.response import Response
from legpush.geometry import Pose2
from legpush.scene.conventions import FrontLeg
from legpush.scene.scenario import Scenario
from tests.agent.fake_world import make_scenario, make_state
from tests.agent.push_model.responses import displaced, response_with

POLICY = DynamicProgramming()
FAR_AWAY = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
SCENARIO = make_scenario()
GOAL = SCENARIO.goal.pose.pose()
WORLDS = {
    "as the model": response_with(),
    "heavy": response_with(forward=(0.8, -0.1)),
    "uneven load": response_with(turn=(1.0, 1.0, 0.0), left=(1.0, 0.15, 0.0)),
    "across a slope": response_with(turn=(0.9, -0.6, 0.0), left=(1.0, -0.2, 0.0)),
    "yields late": response_with(lost_m=0.02),
    "turns easily": response_with(turn=(1.6, 0.0, 0.0)),
}


def pushed_to_the_end(true: Response, box: Pose2, scenario: Scenario = SCENARIO) -> tuple[float, float, int]:
    """Position error, absolute angle error in degrees, and number of pushes."""
    estimate = PushEstimate(scenario.box)
    for n_pushes in range(60):
        push = POLICY.decide(push_view(make_state(FAR_AWAY, box), scenario, estimate.felt))
        if push is None:
            left = GOAL.inverse() @ box
            return hypot(left.x_m, left.y_m), abs(degrees(left.yaw_rad)), n_pushes
        after = box @ displaced(true, push.leg, push.depth_m)
        estimate.learn(box, push, after)
        box = after
    pytest.fail("the policy did not come to an end in 60 pushes")


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize(("left_m", "yaw_deg"), [(0.0, 0.0), (0.12, -8.0), (-0.1, 15.0)])
def test_it_brings_boxes_that_differ_to_the_goal(world: str, left_m: float, yaw_deg: float) -> None:
    start = GOAL @ Pose2(x_m=-1.0, y_m=left_m, yaw_rad=radians(yaw_deg))

    position_m, angle_deg, n_pushes = pushed_to_the_end(WORLDS[world], start)

    assert position_m < 0.025
    assert angle_deg < 1.5
    assert n_pushes < 35


def test_a_box_that_turns_to_the_other_side_is_pushed_with_the_other_leg() -> None:
    view = push_view(make_state(FAR_AWAY, GOAL @ Pose2(x_m=-0.4, y_m=0.0, yaw_rad=0.0)), SCENARIO)
    pushes = []
    for bias in (-1.0, 1.0):
        felt = FeltBox(response=response_with(turn=(1.0, bias, 0.0)))
        push = POLICY.decide(push_view(view.world, SCENARIO, felt))
        assert push is not None
        pushes.append(push)

    right, left = pushes
    assert right.leg != left.leg
    assert right.depth_m == pytest.approx(left.depth_m)
    assert replace(left, leg="FL") != POLICY.decide(view) != replace(left, leg="FR")


def test_equal_views_give_equal_pushes_whatever_was_decided_before() -> None:
    view = push_view(make_state(FAR_AWAY, GOAL @ Pose2(x_m=-0.7, y_m=0.06, yaw_rad=0.1)), SCENARIO)
    other = push_view(
        view.world, SCENARIO, FeltBox(response=response_with(turn=(1.4, 0.3, 0.0), forward=(0.7, 0.0), lost_m=0.02))
    )
    first = DynamicProgramming().decide(view)
    POLICY.decide(other)

    assert POLICY.decide(view) == first == DynamicProgramming().decide(view)


def test_a_box_that_loses_depth_is_pushed_deeper_but_never_too_deep() -> None:
    view = push_view(make_state(FAR_AWAY, GOAL @ Pose2(x_m=-0.05, y_m=0.0, yaw_rad=0.0)), SCENARIO)
    plain, heavy, heaviest = (
        POLICY.decide(push_view(view.world, SCENARIO, FeltBox(response=response_with(lost_m=lost_m))))
        for lost_m in (0.0, 0.02, 0.07)
    )
    assert plain is not None
    assert heavy is not None
    assert heaviest is not None
    assert heavy.depth_m > plain.depth_m
    assert heaviest.depth_m <= 0.1


@pytest.mark.parametrize(
    ("n_pushes", "legs", "is_shallow"),
    [
        ((0, 0), {"FL", "FR"}, True),
        ((0, 1), {"FL"}, True),
        ((0, 4), {"FL"}, True),
        ((2, 0), {"FR"}, True),
        ((1, 1), {"FL", "FR"}, False),
    ],
)
def test_the_first_push_of_each_leg_is_no_deep_one_and_the_second_push_is_that_of_the_other_leg(
    n_pushes: tuple[int, int], legs: set[FrontLeg], is_shallow: bool
) -> None:
    pushes = []
    for yaw_rad in (-0.3, 0.0, 0.3):
        state = make_state(FAR_AWAY, GOAL @ Pose2(x_m=-0.9, y_m=0.0, yaw_rad=yaw_rad))
        push = POLICY.decide(push_view(state, SCENARIO, FeltBox(response=response_with(), n_pushes=n_pushes)))
        assert push is not None
        pushes.append(push)

    assert {push.leg for push in pushes} == legs
    assert all(push.depth_m <= FIRST_M for push in pushes) == is_shallow


def test_it_stops_at_the_goal_and_past_it() -> None:
    for x_m in (0.0, 0.01, 0.2):
        assert (
            POLICY.decide(push_view(make_state(FAR_AWAY, GOAL @ Pose2(x_m=x_m, y_m=0.0, yaw_rad=0.0)), SCENARIO))
            is None
        )


def test_it_is_found_by_its_name_and_recordings_may_name_it() -> None:
    assert isinstance(make_policy("dynamic_programming"), DynamicProgramming)
    assert isinstance(policy_from_data("dynamic_programming", ""), DynamicProgramming)


def test_a_box_that_may_slip_is_first_pushed_less_deep() -> None:
    """Square boxes may be round: a deep push can turn them by more than can be mended."""
    first = {}
    for width_m in (0.4, 0.41):
        scenario = replace(SCENARIO, box=replace(SCENARIO.box, size_m=(0.4, width_m, 0.4)))
        start = make_state(FAR_AWAY, GOAL @ Pose2(x_m=-1.0, y_m=0.2, yaw_rad=radians(-15.0)))
        push = POLICY.decide(push_view(start, scenario))
        assert push is not None
        first[width_m] = push.depth_m

    assert first[0.4] < first[0.41]
