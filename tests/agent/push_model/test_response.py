"""The response of a box: curves that follow what pushes do, each leg for itself, and the depth that is lost."""

from math import radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.model import MIRROR, NOMINAL, PushModel
from agent_proc.push_model.response import Response, ResponseEstimate, expected_response
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS, FrontLeg
from tests.agent.push_model.responses import displaced, response_with

MODEL = PushModel()
DEPTHS_M = (0.02, 0.05, 0.08, 0.1)


def push(leg: FrontLeg, depth_m: float) -> Push:
    return Push(w1=0.5, w2=0.5, leg=leg, depth_m=depth_m)


def fitted(true: Response, n_pushes: int) -> Response:
    estimate, rng = ResponseEstimate(NOMINAL, MODEL), np.random.default_rng(1)
    for index in range(n_pushes):
        leg, depth_m = FRONT_LEGS[index % 2], float(rng.choice(DEPTHS_M))
        estimate.learn(push(leg, depth_m), displaced(true, leg, depth_m))
    return estimate.response


@pytest.mark.parametrize("leg", FRONT_LEGS)
def test_before_the_first_push_it_is_the_model(leg: FrontLeg) -> None:
    ((x_m, y_m, yaw_rad),) = MODEL.push(np.zeros((1, 3)), np.array([MIRROR[leg]]), np.array([0.05])).tolist()

    expected = displaced(expected_response(NOMINAL), leg, 0.05)

    assert (expected.x_m, expected.y_m, expected.yaw_rad) == pytest.approx((x_m, y_m, yaw_rad))
    assert ResponseEstimate(NOMINAL, MODEL).response == expected_response(NOMINAL)


@given(
    forward=st.tuples(st.floats(0.6, 1.2), st.floats(-0.3, 0.2)),
    left=st.tuples(st.floats(0.3, 2.0), st.floats(-0.3, 0.3), st.floats(-0.4, 0.4)),
    turn=st.tuples(st.floats(0.5, 1.8), st.floats(-1.5, 1.5), st.floats(-0.4, 0.4)),
)
def test_after_some_pushes_it_predicts_a_box_that_neither_turns_nor_yields_as_the_model_does(
    forward: tuple[float, float], left: tuple[float, float, float], turn: tuple[float, float, float]
) -> None:
    true = response_with(forward, left, turn)

    found = fitted(true, 20)

    for leg in FRONT_LEGS:
        for depth_m in DEPTHS_M:
            expected, got = displaced(true, leg, depth_m), displaced(found, leg, depth_m)
            assert got.x_m == pytest.approx(expected.x_m, abs=0.003)
            assert got.y_m == pytest.approx(expected.y_m, abs=0.004)
            assert got.yaw_rad == pytest.approx(expected.yaw_rad, abs=radians(1.0))


def test_legs_that_differ_are_told_apart() -> None:
    found = fitted(response_with(turn=(1.0, 1.0, 0.0)), 12)
    turns = [displaced(found, leg, 0.08).yaw_rad for leg in FRONT_LEGS]

    assert sum(turns) == pytest.approx(2 * 0.0596, rel=0.2)


@given(lost_m=st.floats(0.01, 0.05))
def test_a_box_that_yields_late_shows_how_much_depth_it_loses(lost_m: float) -> None:
    found = fitted(response_with(lost_m=lost_m), 12)

    assert found.lost_depth_m == pytest.approx(lost_m, abs=0.006)
    for depth_m in (0.04, 0.07):
        expected = displaced(response_with(lost_m=lost_m), "FL", depth_m)
        assert displaced(found, "FL", depth_m).x_m == pytest.approx(expected.x_m, abs=0.005)


def test_a_box_that_yields_less_and_less_loses_no_depth() -> None:
    assert fitted(response_with(forward=(1.0, -0.3)), 12).lost_depth_m <= 0.0025


def test_a_box_that_may_be_round_is_expected_to_yield_less_and_to_turn_more_and_nobody_knows_how_much() -> None:
    square, oblong = (expected_response(replace(NOMINAL, size_m=(0.4, width_m, 0.4))) for width_m in (0.4, 0.41))
    mirror, depth_m = np.ones(2), np.array([0.03, 0.1])

    assert displaced(square, "FR", 0.08).x_m < displaced(oblong, "FR", 0.08).x_m
    assert displaced(square, "FR", 0.08).yaw_rad > displaced(oblong, "FR", 0.08).yaw_rad
    assert (square.turn_sd_rad(mirror, depth_m) > oblong.turn_sd_rad(mirror, depth_m)).all()


def test_a_box_is_felt_by_pushes_with_any_curve_less_what_the_curve_adds() -> None:
    after = Pose2(x_m=0.03, y_m=0.02, yaw_rad=0.1)
    usual, other = push("FR", 0.05), Push(w1=0.2, w2=0.2, leg="FR", depth_m=0.05)
    forward, left, turn = (float(each[0]) for each in MODEL.beyond_usual_curve(other, np.array([0.05])))
    with_curve = Pose2(x_m=after.x_m + forward, y_m=after.y_m + left, yaw_rad=after.yaw_rad + turn)
    assert abs(turn) > 0.001

    found = [fitted_to(each, moved) for each, moved in ((usual, after), (other, with_curve), (other, after))]
    turns = [displaced(each, "FR", 0.05).yaw_rad for each in found]
    assert turns[0] == pytest.approx(turns[1], abs=1e-4)
    assert turns[0] != pytest.approx(turns[2], abs=1e-3)


def fitted_to(push: Push, moved: Pose2) -> Response:
    """The response that ten equal pushes show."""
    estimate = PushEstimate(NOMINAL)
    for _ in range(10):
        estimate.learn(Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), push, moved)
    assert estimate.felt.response is not None
    return estimate.felt.response


def test_a_longer_box_is_expected_to_turn_less() -> None:
    longer = replace(NOMINAL, size_m=(0.45, 0.5, 0.4))
    expected, usual = (displaced(expected_response(box), "FR", 0.05) for box in (longer, NOMINAL))
    assert expected.yaw_rad < usual.yaw_rad
    assert PushEstimate(longer).felt.response == expected_response(longer)
