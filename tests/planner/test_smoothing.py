"""Shape of the smoothed path."""

import numpy as np
import pytest
from numpy.typing import NDArray

from planner_proc import polylines
from planner_proc.occupancy import ClearanceField
from planner_proc.shortcut import shortcut
from planner_proc.smoothing import smooth
from tests.planner import maps

Floats = NDArray[np.float64]


def curvature(path: Floats) -> Floats:
    """Turn per length at each inner point."""
    bends: Floats = np.abs(polylines.turns(path)) / np.linalg.norm(np.diff(path, axis=0), axis=1)[1:]
    return bends


def test_a_straight_line_in_the_open_stays_one() -> None:
    line = np.array([[1.0, 1.0], [7.0, 5.0]])
    (path,) = smooth(line, ClearanceField(maps.room()), 0.44)
    np.testing.assert_allclose((path - line[0]) @ [-4.0, 6.0], 0.0, atol=1e-9)
    assert polylines.length(path) == pytest.approx(polylines.length(line))


def test_a_corner_with_room_around_it_becomes_a_turn_of_wide_radius() -> None:
    grid = maps.room((0.0, 3.5, 0.0, 3.0), size_m=(12.0, 10.0))
    field = ClearanceField(grid)
    corner = np.array([[1.0, 3.44], [3.94, 3.44], [3.94, 0.6]])
    (path,) = smooth(corner, field, 0.44)
    assert curvature(path).max() < 1.0 / 0.7
    assert polylines.length(path) < 1.05 * polylines.length(corner)
    assert field.path_clearance_m(path) >= 0.44 - 1e-8


def test_points_lie_close_together_and_begin_and_end_where_the_polyline_does() -> None:
    field = ClearanceField(maps.room((3.0, 4.0, 0.0, 4.0)))
    polyline = np.array([[1.0, 1.0], [2.0, 4.6], [5.0, 4.6], [7.0, 1.0]])
    path = np.concatenate(smooth(polyline, field, 0.44))
    assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() <= 0.05 + 1e-9
    np.testing.assert_array_equal(path[[0, -1]], polyline[[0, -1]])


def test_where_nothing_else_fits_the_path_is_the_polyline_turned_on_the_spot() -> None:
    # Corridors exactly as wide as twice the clearance: only their middle lines are free.
    cells = np.ones((60, 60), dtype=np.bool_)
    cells[10:20, :30] = cells[10:50, 20:30] = cells[40:50, 20:] = False
    grid = maps.grid(cells, 0.1)
    polyline = np.array([[0.5, 1.5], [2.5, 1.5], [2.5, 4.5], [5.5, 4.5]])
    field = ClearanceField(grid)
    assert field.free_segments(polyline, 0.5).all()
    stretches = smooth(polyline, field, 0.5)
    np.testing.assert_allclose([stretch[0] for stretch in stretches], polyline[:-1], atol=1e-9)
    path = np.concatenate(stretches)
    assert maps.true_clearance(grid, maps.samples(path, 0.005)).min() >= 0.5 - 1e-7
    assert polylines.length(path) == pytest.approx(polylines.length(polyline))


def test_only_the_narrow_part_falls_back_to_the_polyline() -> None:
    cells = np.zeros((80, 160), dtype=np.bool_)
    cells[:, :60] = True
    cells[30:40, :60] = cells[30:80, 20:30] = False
    field = ClearanceField(maps.grid(cells, 0.1))
    polyline = np.array([[2.5, 7.4], [2.5, 3.5], [8.0, 3.5], [10.0, 6.0], [14.0, 6.0]])
    stretches = smooth(polyline, field, 0.5)
    np.testing.assert_allclose([stretch[0] for stretch in stretches[1:]], [[2.5, 3.5]], atol=1e-9)
    assert curvature(stretches[1]).max() < 1.0 / 0.3
    assert not np.isclose(stretches[1], [10.0, 6.0], atol=0.02).all(axis=1).any()


@pytest.mark.parametrize("length_m", [1e-6, 1e-3, 0.04, 0.3])
def test_the_shortest_paths_are_straight(length_m: float) -> None:
    line = np.array([[3.0, 3.0], [3.0 + length_m, 3.0]])
    (path,) = smooth(line, ClearanceField(maps.room()), 0.44)
    assert len(path) >= 2
    np.testing.assert_allclose(path[:, 1], 3.0, atol=1e-12)
    assert (np.diff(path[:, 0]) > 0.0).all()


def test_a_shortcut_is_free_and_no_longer_and_taut_in_the_open() -> None:
    grid = maps.room((3.0, 4.0, 0.0, 4.0))
    field = ClearanceField(grid)
    jagged = np.array([[1.0, 1.0], [0.6, 3.0], [2.0, 3.2], [1.8, 5.4], [4.5, 4.8], [6.0, 5.4], [5.0, 3.0], [7.0, 1.0]])
    assert field.free_segments(jagged, 0.44).all()
    path = shortcut(jagged, field, 0.44)
    assert maps.true_clearance(grid, maps.samples(path, 0.005)).min() >= 0.44 - 1e-8
    shortest = 2 * np.hypot(1.56, 3.0) + np.hypot(0.0, 1.0)
    assert shortest < polylines.length(path) < 0.75 * polylines.length(jagged)
    np.testing.assert_array_equal(path[[0, -1]], jagged[[0, -1]])
    detour = np.array([[0.6, 5.0], [1.0, 5.4], [2.0, 4.6], [2.4, 5.0]])
    np.testing.assert_array_equal(shortcut(detour, field, 0.44), detour[[0, -1]])
