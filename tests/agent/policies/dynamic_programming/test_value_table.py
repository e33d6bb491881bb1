"""The values of poses: the errors at the goal, less where a push helps, and the costs of what pushes lead to."""

import dataclasses
from math import radians

import numpy as np
import pytest

from agent_proc.policies.dynamic_programming.value_table import CYCLE_COST, Problem, ValueTable
from legpush.arrays import Floats
from tests.agent.push_model.responses import response_with

PROBLEM = Problem(response=response_with(), least_m=0.005, most_m=0.1, near_m=0.03, near_rad=radians(3.0))
TABLE = ValueTable(PROBLEM)
MIRROR, DEPTH_M = PROBLEM.pushes(24)


def costs(x_m: float, y_m: float, yaw_deg: float, table: ValueTable = TABLE) -> Floats:
    return table.costs((x_m, y_m, radians(yaw_deg)), PROBLEM.response, MIRROR, DEPTH_M)


def test_from_a_place_ahead_of_the_goal_the_error_becomes_small() -> None:
    for x_m, y_m, yaw_deg in ((-1.0, 0.1, 10.0), (-0.8, -0.15, 20.0), (-0.6, 0.05, -5.0)):
        assert costs(x_m, y_m, yaw_deg).min() < 0.4


def test_too_near_to_be_turned_the_error_stays() -> None:
    assert costs(-0.05, 0.1, 20.0).min() > 2.0


def test_it_leads_to_what_it_promises() -> None:
    """Pushing as the table says, in a world that follows the response, costs about its value."""
    x_m, y_m, yaw_rad, n_pushes = -0.9, 0.12, radians(-10.0), 0
    promised = float(costs(x_m, y_m, np.degrees(yaw_rad)).min())
    while True:
        found = costs(x_m, y_m, float(np.degrees(yaw_rad)))
        error = float(PROBLEM.error(*np.array([[x_m], [y_m], [yaw_rad]]))[0])
        if found.min() > error - CYCLE_COST:
            break
        index = int(found.argmin())
        forward, left, turn = PROBLEM.response.displacement(MIRROR[[index]], DEPTH_M[[index]])
        c, s = np.cos(yaw_rad), np.sin(yaw_rad)
        x_m += float(c * forward[0] - s * left[0])
        y_m += float(s * forward[0] + c * left[0])
        yaw_rad += float(turn[0])
        n_pushes += 1
        assert n_pushes < 60

    assert error + CYCLE_COST * n_pushes == pytest.approx(promised, abs=0.25)
    assert error < 0.3


def test_mirror_images_cost_the_same() -> None:
    n = len(MIRROR) // 2
    left, right = costs(-0.7, 0.08, -6.0), costs(-0.7, -0.08, 6.0)
    np.testing.assert_allclose(left[:n], right[n:], atol=1e-9)


def test_a_box_that_turns_to_one_side_is_led_otherwise() -> None:
    """A centre of mass on the other side of the middle makes the mirror image of all costs."""
    found = {}
    for bias in (-1.0, 1.0):
        aside = dataclasses.replace(PROBLEM, response=response_with(turn=(1.0, bias, 0.0)))
        found[bias] = ValueTable(aside).costs((-0.4, 0.0, 0.0), aside.response, MIRROR, DEPTH_M)
    n = len(MIRROR) // 2

    np.testing.assert_allclose(found[-1.0][:n], found[1.0][n:], atol=1e-9)
    assert found[1.0][:n].min() != pytest.approx(found[1.0][n:].min(), abs=0.01)


def test_pushes_too_short_for_the_table_are_left_out_where_others_are_possible() -> None:
    found = costs(-0.8, 0.1, 5.0)
    assert np.isinf(found[0])
    assert np.isfinite(found).any()
    tiny = TABLE.costs((-0.8, 0.1, 0.0), PROBLEM.response, np.ones(2), np.array([0.005, 0.006]))
    assert np.isfinite(tiny).all()


def test_pushes_whose_turn_is_not_known_cost_more() -> None:
    fl, fr = PROBLEM.response.curves
    unsure = dataclasses.replace(fl, turn_sd_rad=tuple(2.0 * depth_m for depth_m in PROBLEM.response.depth_m))
    response = dataclasses.replace(PROBLEM.response, curves=(unsure, fr))
    found = TABLE.costs((-0.3, 0.0, 0.0), response, MIRROR, DEPTH_M)
    known, n = costs(-0.3, 0.0, 0.0), len(MIRROR) // 2

    assert found[n - 1] > known[n - 1]
    np.testing.assert_array_equal(found[n:], known[n:])
