"""The draw of a response: it has the moments of the distribution that an estimate begins with."""

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.push_model.drawn_response import drawn_response
from agent_proc.push_model.model import MIRROR, NOMINAL, nearest_model
from agent_proc.push_model.response import MOST_LOST_M, Response, ResponseEstimate, expected_curves, kind_of
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS, FrontLeg
from legpush.scene.scenario import Box

LONG = replace(NOMINAL, size_m=(0.6, 0.35, 0.4))
SQUARE = replace(NOMINAL, size_m=(0.5, 0.5, 0.4))
N = 3000
DEPTHS_M = (0.05, 0.1, 0.02, 0.08)


@pytest.mark.parametrize("box", [LONG, SQUARE])
def test_curves_have_the_mean_and_the_covariance_of_what_is_expected_of_such_boxes(box: Box) -> None:
    model, random, kind = nearest_model(box), np.random.default_rng(1), kind_of(box)
    drawn = [drawn_response(box, random) for _ in range(N)]

    depth_m = np.array(model.depth_m)
    rows = ("forward_m", "left_m", "turn_rad")
    for row, expected, spread in zip(
        rows, expected_curves(box, model), (kind.forward, kind.left, kind.turn), strict=True
    ):
        fl, fr = (np.array([getattr(each.curves[leg], row) for each in drawn]) for leg in (0, 1))
        common, opposite = spread.common.covariance(depth_m), spread.opposite.covariance(depth_m)
        scale = np.sqrt(np.diagonal(common + opposite).max())
        for found, covariance in (
            (np.cov(fl, rowvar=False), common + opposite),
            (np.cov(fr, rowvar=False), common + opposite),
            ((fl - expected).T @ (fr - expected) / N, common - opposite),
        ):
            assert found == pytest.approx(covariance, abs=0.1 * scale**2)
        assert fl.mean(axis=0) == pytest.approx(expected, abs=5.0 * scale / np.sqrt(N))
        assert fr.mean(axis=0) == pytest.approx(expected, abs=5.0 * scale / np.sqrt(N))
    lost_m = np.array([each.lost_depth_m for each in drawn])
    assert lost_m.mean() == pytest.approx(kind.lost_mean_m, rel=0.1)
    assert lost_m.max() <= MOST_LOST_M


def test_an_estimate_finds_the_response_that_was_drawn() -> None:
    drawn = drawn_response(LONG, np.random.default_rng(5))
    estimate = ResponseEstimate(LONG, nearest_model(LONG))
    before_rad = largest_turn_error_rad(estimate.response, drawn)

    for depth_m in DEPTHS_M * 6:
        for leg in FRONT_LEGS:
            forward_m, left_m, turn_rad = moved(drawn, leg, depth_m)
            push = Push(w1=drawn.w1, w2=drawn.w2, leg=leg, depth_m=depth_m)
            estimate.learn(push, Pose2(x_m=forward_m, y_m=left_m, yaw_rad=turn_rad))

    assert largest_turn_error_rad(estimate.response, drawn) < 0.1 * before_rad


def moved(response: Response, leg: FrontLeg, depth_m: float) -> tuple[float, ...]:
    """Displacement by a push of this depth, of which the first part is lost."""
    yields_m = np.array([max(depth_m - response.lost_depth_m, 0.0)])
    return tuple(float(each[0]) for each in response.displacement(np.array([MIRROR[leg]]), yields_m))


def largest_turn_error_rad(response: Response, drawn: Response) -> float:
    return max(
        abs(moved(response, leg, depth_m)[2] - moved(drawn, leg, depth_m)[2])
        for leg in FRONT_LEGS
        for depth_m in DEPTHS_M
    )
