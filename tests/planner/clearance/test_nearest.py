"""Tiles of nearest cells against the distance transform of the whole grid."""

import numpy as np
import pytest
from scipy import ndimage

from legpush.arrays import Flags
from planner_proc.clearance.nearest import NearestCells

REACH = 9


def solid(seed: int) -> Flags:
    """A large map with a few things on it, whose outermost cells are occupied."""
    rng = np.random.default_rng(seed)
    occupied = rng.random((230 + 17 * seed, 410)) < 0.0004
    for _ in range(6):
        row, column = rng.integers(0, 220), rng.integers(0, 400)
        occupied[row : row + rng.integers(1, 30), column : column + rng.integers(1, 30)] = True
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    return occupied


@pytest.mark.parametrize("seed", range(4))
def test_a_tile_knows_the_nearest_cells_within_reach_as_the_whole_grid_does(seed: int) -> None:
    occupied = solid(seed)
    distances, expected = ndimage.distance_transform_edt(~occupied, return_indices=True)
    nearest = NearestCells(occupied, REACH)
    rows, columns = np.random.default_rng(seed).integers(0, occupied.shape, (60, 2)).T

    found = nearest.squares(rows, columns)
    scalar = [nearest.square(row, column) for row, column in zip(rows.tolist(), columns.tolist(), strict=True)]

    near = distances[rows, columns] <= REACH
    assert 5 < near.sum() < 55
    assert (found[:, near] == expected[:, rows, columns][:, near]).all()
    assert scalar == [(row, column) for row, column in found.T.tolist()]
    assert occupied[found[0], found[1]].all()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("enough", [0.0, 5.0, np.inf])
def test_no_bound_is_above_the_distance_of_the_squares_and_none_below_enough_is_loose(seed: int, enough: float) -> None:
    occupied = solid(seed)
    distances = ndimage.distance_transform_edt(~occupied)
    nearest = NearestCells(occupied, REACH)
    rows, columns = np.random.default_rng(seed).integers(0, occupied.shape, (60, 2)).T

    bounds = nearest.bounds(rows, columns, enough)

    apart = np.maximum(distances[rows, columns] - np.sqrt(2.0), 0.0)
    assert (bounds <= apart).all()
    close = (distances[rows, columns] <= REACH) & (bounds <= enough)
    assert (bounds[close] >= (1.0 - 2e-6) * apart[close]).all()
    one_by_one = [
        nearest.bound(row, column, enough) for row, column in zip(rows.tolist(), columns.tolist(), strict=True)
    ]
    assert (np.maximum(one_by_one, 0.0) >= bounds).all()


def test_where_much_is_asked_for_the_whole_grid_is_worked_out() -> None:
    occupied = solid(0)
    _, expected = ndimage.distance_transform_edt(~occupied, return_indices=True)
    nearest = NearestCells(occupied, REACH)
    rows, columns = np.indices(occupied.shape).reshape(2, -1)

    assert (nearest.squares(rows, columns) == expected.reshape(2, -1)).all()
