"""Shape of the smoothed path."""

from typing import Any

import numpy as np
import pytest

from legpush.arrays import Floats
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.paths import distances_m
from legpush.scene.plan_settings import Smoothing
from planner_proc.clearance.field import ClearanceField
from planner_proc.smoothing import polylines
from planner_proc.smoothing.spline import smooth
from planner_proc.smoothing.tube import Tube
from tests.planner import maps

BAND = Smoothing()
CORNER = np.array([[1.0, 1.0], [4.0, 1.0], [4.0, 5.0], [7.0, 5.0]])


def curvature(path: Floats) -> Floats:
    """Turn per length at each inner point."""
    bends: Floats = np.abs(polylines.turns(path)) / np.linalg.norm(np.diff(path, axis=0), axis=1)[1:]
    return bends


def test_a_straight_line_in_the_open_stays_one() -> None:
    line = np.array([[1.0, 1.0], [7.0, 5.0]])
    (path,) = smooth(line, Tube(ClearanceField(maps.room()), 0.44, line), BAND)
    np.testing.assert_allclose((path - line[0]) @ [-4.0, 6.0], 0.0, atol=1e-9)
    assert polylines.length(path) == pytest.approx(polylines.length(line))


def test_a_corner_with_room_around_it_becomes_a_turn_of_wide_radius() -> None:
    grid = maps.room((0.0, 3.5, 0.0, 3.0), size_m=(12.0, 10.0))
    field = ClearanceField(grid)
    corner = np.array([[1.0, 3.44], [3.94, 3.44], [3.94, 0.6]])
    (path,) = smooth(corner, Tube(field, 0.44, corner), BAND)
    assert curvature(path).max() < 1.0 / 0.7
    assert polylines.length(path) < 1.05 * polylines.length(corner)
    assert field.path_clearance_m(path) >= 0.44 - 1e-8


def test_points_lie_close_together_and_begin_and_end_where_the_polyline_does() -> None:
    field = ClearanceField(maps.room((3.0, 4.0, 0.0, 4.0)))
    polyline = np.array([[1.0, 1.0], [2.0, 4.6], [5.0, 4.6], [7.0, 1.0]])
    path = np.concatenate(smooth(polyline, Tube(field, 0.44, polyline), BAND))
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
    stretches = smooth(polyline, Tube(field, 0.5, polyline), BAND)
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
    stretches = smooth(polyline, Tube(field, 0.5, polyline), BAND)
    np.testing.assert_allclose([stretch[0] for stretch in stretches[1:]], [[2.5, 3.5]], atol=1e-9)
    assert curvature(stretches[1]).max() < 1.0 / 0.3
    assert not np.isclose(stretches[1], [10.0, 6.0], atol=0.02).all(axis=1).any()


@pytest.mark.parametrize("length_m", [1e-6, 1e-3, 0.04, 0.3])
def test_the_shortest_paths_are_straight(length_m: float) -> None:
    line = np.array([[3.0, 3.0], [3.0 + length_m, 3.0]])
    (path,) = smooth(line, Tube(ClearanceField(maps.room()), 0.44, line), BAND)
    assert len(path) >= 2
    np.testing.assert_allclose(path[:, 1], 3.0, atol=1e-12)
    assert (np.diff(path[:, 0]) > 0.0).all()


def smoothed(grid: OccupancyGrid, polyline: Floats, radius_m: float = 0.0, **options: Any) -> list[Floats]:
    field = ClearanceField(grid)
    chosen = Smoothing(**options)
    stretches = smooth(polyline, Tube(field, 0.44, polyline, chosen.max_deviation_m), chosen, radius_m)
    for stretch in stretches:
        assert field.path_clearance_m(stretch) >= 0.44 - 1e-8
    return stretches


def test_without_smoothing_the_path_is_the_polyline() -> None:
    stretches = smoothed(maps.room(), CORNER, method="none")
    np.testing.assert_allclose([stretch[0] for stretch in stretches], CORNER[:-1])
    assert sum(polylines.length(stretch) for stretch in stretches) == pytest.approx(polylines.length(CORNER))


def test_the_papers_spline_goes_through_the_corners() -> None:
    (path,) = smoothed(maps.room(), CORNER, method="spline")
    assert distances_m(CORNER, path).max() < 0.01
    assert polylines.length(path) > polylines.length(CORNER[[0, -1]])


def test_a_spline_that_collides_is_drawn_back_to_the_polyline() -> None:
    grid = maps.room((0.0, 3.5, 1.5, 6.0), (4.5, 8.0, 0.0, 4.5))
    path = np.concatenate(smoothed(grid, CORNER, method="spline"))
    assert distances_m(CORNER, path).max() < 0.05


@pytest.mark.parametrize("deviation_m", [0.01, 0.05, 0.15, 0.4])
def test_the_path_stays_as_near_to_that_of_the_search_as_was_asked_for(deviation_m: float) -> None:
    path = np.concatenate(smoothed(maps.room(), CORNER, max_deviation_m=deviation_m))
    dense = maps.samples(path, 0.01)
    assert distances_m(dense, CORNER).max() <= deviation_m + 1e-6
    assert distances_m(dense, CORNER).max() > 0.2 * deviation_m


@pytest.mark.parametrize("radius_m", [0.3, 0.8, 1.4])
@pytest.mark.parametrize("method", ["band", "spline"])
def test_the_path_turns_no_tighter_than_the_turning_radius(radius_m: float, method: str) -> None:
    (path,) = smoothed(maps.room(), CORNER, radius_m, method=method)
    assert polylines.turning_radii(path).min() >= 0.99 * radius_m
    np.testing.assert_allclose(path[[0, -1]], CORNER[[0, -1]])
    assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() <= 0.05 + 1e-9


def test_there_is_no_path_where_nothing_turns_so_wide() -> None:
    narrow = maps.room((0.0, 3.5, 1.5, 6.0), (4.5, 8.0, 0.0, 4.5))
    assert smoothed(narrow, CORNER, 1.0) == []


@pytest.mark.parametrize("n", [20, 50, 200])
def test_a_smooth_path_has_no_more_waypoints_than_were_asked_for(n: int) -> None:
    path = np.concatenate(smoothed(maps.room(), CORNER, max_waypoints=n))
    assert 0.5 * min(n, polylines.length(path) / 0.05) < len(path) <= n - 2


def test_more_comfort_keeps_farther_away() -> None:
    grid = maps.room((0.0, 3.5, 1.5, 3.0), size_m=(12.0, 10.0))
    corner = np.array([[1.0, 3.44], [3.94, 3.44], [3.94, 0.6]])
    field = ClearanceField(grid)
    near, far = (np.concatenate(smoothed(grid, corner, comfort_m=comfort_m))[20:-20] for comfort_m in (0.0, 0.6))
    assert field.clearance_m(far).mean() > field.clearance_m(near).mean() + 0.05
