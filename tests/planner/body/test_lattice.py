"""The cheapest motion of the body on the lattice."""

import numpy as np
import pytest

from legpush.scene.occupancy import OccupancyGrid
from planner_proc.body.lattice import search
from planner_proc.body.motion import filled
from planner_proc.body.space import BodySpace
from planner_proc.clearance.field import ClearanceField
from tests.planner.bodies import BODY, BODY_M, least_distance_m
from tests.planner.maps import room


def space_of(grid: OccupancyGrid) -> BodySpace:
    return BodySpace(grid, ClearanceField(grid), 0.25, BODY, BODY_M)


def test_in_the_open_it_is_about_a_turn_a_line_and_a_turn() -> None:
    start, goal = np.array([2.0, 2.0, 0.0]), np.array([2.0, 4.0, np.pi / 2])

    poses = search(space_of(room()), start, goal, np.stack([start, goal])[:, :2], 1.0, 0.1)

    np.testing.assert_allclose(poses[0], start)
    np.testing.assert_allclose(poses[-1], goal)
    length_m = np.hypot(*np.diff(poses[:, :2], axis=0).T).sum()
    assert 2.0 <= length_m < 2.3
    assert np.abs(np.diff(np.unwrap(poses[:, 2]))).sum() == pytest.approx(np.pi / 2)


def test_the_body_backs_out_of_a_dead_end_in_which_it_cannot_turn() -> None:
    corridor = room((0.0, 3.0, 0.0, 2.0), (0.0, 3.0, 3.0, 6.0), (0.0, 0.2, 2.0, 3.0))
    start, goal = np.array([1.2, 2.5, np.pi]), np.array([5.0, 2.5, 0.0])

    poses = search(space_of(corridor), start, goal, filled(np.stack([start, goal]), 0.1)[:, :2], 1.0, 0.1)

    inside = poses[poses[:, 0] < 2.5]
    assert len(inside) > 5
    assert np.abs(np.cos(inside[:, 2]) + 1.0).max() < 0.1, "it turns where it has no room"
    assert least_distance_m(corridor, BODY, np.column_stack([poses[:, :2], np.unwrap(poses[:, 2])])) > BODY_M - 0.01


def test_there_is_none_through_a_gate_that_is_narrower_than_the_body() -> None:
    gate = room((4.0, 4.2, 0.0, 2.8), (4.0, 4.2, 3.3, 6.0))
    start, goal = np.array([2.0, 3.0, 0.0]), np.array([6.0, 3.0, 0.0])
    along_m = filled(np.stack([start, goal]), 0.1)[:, :2]

    assert not len(search(space_of(gate), start, goal, along_m, 2.0, 0.1))
    wider = room((4.0, 4.2, 0.0, 2.7), (4.0, 4.2, 3.3, 6.0))
    assert len(search(space_of(wider), start, goal, along_m, 2.0, 0.1))


def test_a_lattice_along_a_very_long_way_is_not_searched() -> None:
    start, goal = np.array([2.0, 3.0, 0.0]), np.array([900.0, 3.0, 0.0])

    assert not len(search(space_of(room()), start, goal, np.stack([start, goal])[:, :2], 1.0, 0.1))
    along_m = filled(np.stack([start, goal]), 0.1)[:, :2]
    assert not len(search(space_of(room()), start, goal, along_m, 8.0, 0.1))
