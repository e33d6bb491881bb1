"""Elastic bands: where they settle."""

import numpy as np
import pytest

from legpush.arrays import Floats
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.clearance.field import ClearanceField
from planner_proc.smoothing import polylines
from planner_proc.smoothing.band import ElasticBand
from tests.planner import maps

CORNER = np.array([[1.0, 1.0], [4.0, 1.0], [4.0, 5.0]])
CLEARANCE_M = 0.44


def settled(
    path_m: Floats,
    grid: OccupancyGrid,
    *,
    comfort_m: float = 0.0,
    stiffness: float = 1.0,
    max_deviation_m: float | None = None,
    n: int = 1,
) -> ElasticBand:
    band = ElasticBand(path_m, ClearanceField(grid), CLEARANCE_M, comfort_m, stiffness, max_deviation_m)
    for _ in range(n):
        band.settle()
    return band


def test_a_band_is_laid_along_the_path_with_equal_spaces() -> None:
    band = settled(CORNER, maps.room(), n=0)

    assert band.knots_at_m[[0, -1]].tolist() == [0.0, 7.0]
    np.testing.assert_allclose(np.diff(band.knots_at_m), band.knots_at_m[1])
    np.testing.assert_array_equal(band.knots_m[[0, -1]], CORNER[[0, -1]])


def test_in_the_open_a_band_becomes_shorter_and_rounder_and_keeps_its_ends() -> None:
    laid, band = settled(CORNER, maps.room(), n=0), settled(CORNER, maps.room())

    np.testing.assert_array_equal(band.knots_m[[0, -1]], CORNER[[0, -1]])
    assert polylines.length(band.knots_m) < polylines.length(laid.knots_m) - 0.3
    assert np.abs(polylines.turns(band.knots_m)).max() < 0.3 * np.abs(polylines.turns(laid.knots_m)).max()


def test_a_band_leaves_an_obstacle_by_the_clearance_at_least_and_by_the_comfort_if_there_is_room() -> None:
    grid = maps.room((2.5, 3.5, 0.0, 2.9))
    line = np.array([[1.0, 3.2], [5.0, 3.2]])
    field = ClearanceField(grid)
    near, far = (settled(line, grid, comfort_m=comfort_m, n=4) for comfort_m in (0.0, 0.5))

    middle = slice(len(near.knots_m) // 2 - 3, len(near.knots_m) // 2 + 4)
    assert field.clearance_m(near.knots_m[middle]).min() >= CLEARANCE_M
    assert field.clearance_m(far.knots_m[middle]).min() > field.clearance_m(near.knots_m[middle]).min() + 0.1


def test_a_stiffer_band_bends_less() -> None:
    tight, wide = (settled(CORNER, maps.room(), stiffness=stiffness) for stiffness in (0.5, 2.0))

    assert polylines.turning_radii(wide.knots_m).min() > 1.3 * polylines.turning_radii(tight.knots_m).min()


@pytest.mark.parametrize("deviation_m", [0.05, 0.3])
def test_no_knot_goes_farther_from_where_it_was_laid_than_was_asked_for(deviation_m: float) -> None:
    laid, band = settled(CORNER, maps.room(), n=0), settled(CORNER, maps.room(), max_deviation_m=deviation_m)

    moved_m = np.hypot(*(band.knots_m - laid.knots_m).T)
    assert 0.7 * deviation_m < moved_m.max() <= deviation_m
