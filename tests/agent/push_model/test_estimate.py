"""The estimate of what a push does: it begins as a model and follows the pushes that it is shown."""

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.push_model.estimate import LEAST_LOST_M, LEAST_SCALE, MOST_SCALE, PushEstimate
from agent_proc.push_model.model import NOMINAL, ON_ITS_SIDE, PushModel
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS, FrontLeg
from legpush.scene.scenario import Box

START = Pose2(x_m=1.0, y_m=2.0, yaw_rad=0.7)


def push(leg: FrontLeg = "FL", w: float = 0.5) -> Push:
    return Push(w1=w, w2=w, leg=leg, depth_m=0.05)


def moved(leg: FrontLeg, travel_scale: float, turn_scale: float) -> Pose2:
    """Where a push takes a box that starts at `START`."""
    row = np.array([[START.x_m, START.y_m, START.yaw_rad]])
    mirror = np.array([1.0 if leg == "FL" else -1.0])
    ((x_m, y_m, yaw_rad),) = PushModel().push(row, mirror, np.array([0.05]), travel_scale, turn_scale).tolist()
    return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)


def learned(n_pushes: int, travel_scale: float, turn_scale: float) -> PushEstimate:
    estimate = PushEstimate(NOMINAL)
    for index in range(n_pushes):
        leg = FRONT_LEGS[index % 2]
        estimate.learn(START, push(leg), moved(leg, travel_scale, turn_scale))
    return estimate


@pytest.mark.parametrize("leg", FRONT_LEGS)
def test_before_the_first_push_it_is_the_model_of_the_box(leg: FrontLeg) -> None:
    estimate = PushEstimate(NOMINAL)
    after, expected = estimate.after(START, push(leg)), moved(leg, 1.0, 1.0)

    assert (estimate.travel_scale, estimate.turn_scale, estimate.curve) == (1.0, 1.0, (0.5, 0.5))
    assert (after.x_m, after.y_m, after.yaw_rad) == pytest.approx((expected.x_m, expected.y_m, expected.yaw_rad))


def test_a_box_that_was_not_measured_turns_by_its_shape() -> None:
    longer = replace(NOMINAL, size_m=(0.45, 0.5, 0.4))
    prior = (0.5 / (0.45**2 + 0.5**2)) / (0.5 / (0.4**2 + 0.5**2))

    assert PushEstimate(longer).turn_scale == pytest.approx(prior)
    assert PushEstimate(replace(NOMINAL, size_m=(0.5, 0.4, 0.4))).after(START, push()) == PushEstimate(
        ON_ITS_SIDE.box, ON_ITS_SIDE
    ).after(START, push())


def test_it_follows_what_pushes_do_to_travel_and_turn() -> None:
    few, many = learned(2, 0.8, 1.5), learned(20, 0.8, 1.5)

    assert 0.8 < many.travel_scale < few.travel_scale < 1.0
    assert 1.0 < few.turn_scale < many.turn_scale < 1.5
    assert many.travel_scale == pytest.approx(0.8, abs=0.03)
    assert many.turn_scale == pytest.approx(1.5, abs=0.1)
    assert many.turning_radius_m == pytest.approx(0.8 / 1.5 * PushEstimate(NOMINAL).turning_radius_m, rel=0.1)


def test_its_scales_have_limits() -> None:
    high, low = learned(40, 10.0, 10.0), learned(40, 0.0, 0.0)

    assert (high.travel_scale, high.turn_scale) == (MOST_SCALE, MOST_SCALE)
    assert (low.travel_scale, low.turn_scale) == (LEAST_SCALE, LEAST_SCALE)


def test_later_pushes_count_more_than_earlier_ones() -> None:
    estimate = learned(20, 1.5, 1.0)
    for _ in range(20):
        estimate.learn(START, push(), moved("FL", 0.7, 1.0))

    assert estimate.travel_scale == pytest.approx(0.75, abs=0.06)


def test_a_push_with_another_curve_teaches_nothing() -> None:
    estimate = PushEstimate(NOMINAL)
    estimate.learn(START, push(w=0.2), moved("FL", 0.5, 0.5))

    assert (estimate.travel_scale, estimate.turn_scale) == (1.0, 1.0)


def test_the_axle_does_not_slip_sideways_when_one_foot_turns_the_box() -> None:
    estimate = PushEstimate(NOMINAL)
    axle_b = Pose2(x_m=-estimate.axle_m, y_m=0.0, yaw_rad=0.0)
    origin = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    after = estimate.after(origin, push("FR")) @ axle_b

    assert estimate.axle_m > 0.1
    assert after.y_m == pytest.approx(0.0, abs=1e-3)
    assert after.x_m > axle_b.x_m


def pushed_by(estimate: PushEstimate, depth_m: float, lost_m: float) -> None:
    """Let the estimate learn a push that moves the box as one of the model with a part of the depth."""
    forward_m = estimate.commanded_m(max(depth_m - lost_m, 0.0))
    estimate.learn(START, replace(push(w=0.4), depth_m=depth_m), START @ Pose2(x_m=forward_m, y_m=0.0, yaw_rad=0.0))


@pytest.mark.parametrize("box", [NOMINAL, ON_ITS_SIDE.box])
@pytest.mark.parametrize("lost_m", [0.0, 0.001, 0.0035, 0.0066, 0.0135, 0.027])
def test_the_depth_that_a_heavy_box_loses_is_found_at_every_depth_and_with_every_curve(lost_m: float, box: Box) -> None:
    estimate = PushEstimate(box)
    for depth_m in (0.06, 0.06, 0.05, 0.05, 0.04, 0.03, 0.03):
        pushed_by(estimate, depth_m, lost_m)

    assert estimate.lost_depth_m == (0.0 if lost_m < LEAST_LOST_M else pytest.approx(lost_m, rel=0.3))
    for _ in range(5):
        pushed_by(estimate, 0.01 + lost_m, lost_m)
    assert estimate.lost_depth_m == (0.0 if lost_m < LEAST_LOST_M else pytest.approx(lost_m, rel=0.1))


def test_pushes_that_do_not_move_the_box_show_that_it_loses_more() -> None:
    estimate = PushEstimate(NOMINAL)
    pushed_by(estimate, 0.02, 0.03)
    seen_m = [estimate.lost_depth_m]
    for depth_m in (0.005, 0.022, 0.025):
        pushed_by(estimate, depth_m, 0.03)
        seen_m.append(estimate.lost_depth_m)

    assert 0.0 < seen_m[0] <= seen_m[1] < seen_m[2] < seen_m[3] <= 0.03


def test_a_box_that_slides_on_loses_nothing() -> None:
    estimate = PushEstimate(NOMINAL)
    for _ in range(10):
        pushed_by(estimate, 0.05, -0.004)

    assert estimate.lost_depth_m == 0.0
