"""What motions of the body cost, and the poses in between."""

from math import pi

import numpy as np
import pytest

from planner_proc.body.motion import cost_m, effort, filled, turn_rad


def test_ahead_is_the_cheapest_direction_and_sideways_the_dearest() -> None:
    ahead, back, aside = effort(np.array([0.0, pi, pi / 2])).tolist()

    assert ahead == 1.0 < back < aside
    assert effort(np.array([-pi / 2])).tolist() == [aside]


def test_turns_go_the_short_way_round() -> None:
    assert turn_rad(3.0, -3.0) == pytest.approx(2 * pi - 6.0)
    assert turn_rad(-3.0, 3.0) == pytest.approx(6.0 - 2 * pi)


def test_a_line_costs_its_length_and_a_turn_its_angle() -> None:
    line = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    turn = np.array([[2.0, 0.0, 0.0], [2.0, 0.0, -1.5]])

    assert cost_m(line, 0.6) == pytest.approx(2.0)
    assert cost_m(turn, 0.6) == pytest.approx(0.9)
    assert cost_m(np.concatenate([line, turn[1:]]), 0.6) == pytest.approx(2.9)


def test_filled_poses_are_near_each_other_and_keep_the_given_ones() -> None:
    poses = np.array([[0.0, 0.0, 3.0], [0.3, 0.4, -3.0], [0.3, 0.4, -1.0]])

    dense = filled(poses, 0.05, 0.1)
    steps = np.diff(dense, axis=0)

    assert np.hypot(*steps[:, :2].T).max() <= 0.05 + 1e-12
    assert np.abs(np.sin(steps[:, 2])).max() <= 0.1
    np.testing.assert_allclose(dense[[0, -1], :2], poses[[0, -1], :2])
    assert dense[-1, 2] == pytest.approx(-1.0)
