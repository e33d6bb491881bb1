"""Clearance against every square looked at one by one."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from legpush.arrays import Floats
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.clearance.field import ClearanceField
from tests.planner import maps

Case = tuple[OccupancyGrid, Floats]


@st.composite
def grids(draw: st.DrawFn) -> OccupancyGrid:
    """Small maps from empty to full, of coarse and fine cells, anywhere."""
    shape = draw(st.tuples(st.integers(1, 14), st.integers(1, 14)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    cells = rng.random(shape) < draw(st.sampled_from([0.0, 0.03, 0.15, 0.5, 1.0]))
    origin_m = draw(st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0)))
    return maps.grid(cells, draw(st.sampled_from([0.05, 0.3, 1.0])), origin_m)


@st.composite
def grids_with_points(draw: st.DrawFn, n: int) -> Case:
    """A map and points on it, a little beside it, and on the very borders of its cells."""
    grid = draw(grids())
    units = []
    for n_cells in (grid.n_columns, grid.n_rows):
        anywhere = st.floats(-0.5, n_cells + 0.5)
        border = st.integers(0, n_cells).map(float)
        units.append(draw(st.lists(st.one_of(anywhere, border), min_size=n, max_size=n)))
    return grid, np.array(units).T * grid.resolution_m + np.array(grid.origin_m)


@given(grids_with_points(n=12))
def test_clearance_is_the_distance_to_the_nearest_square(case: Case) -> None:
    grid, points = case
    measured = ClearanceField(grid).clearance_m(points)
    np.testing.assert_allclose(measured, maps.true_clearance(grid, points), atol=1e-9)


@settings(max_examples=200)
@given(grids_with_points(n=2), st.floats(0.01, 3.0))
def test_a_segment_is_free_exactly_where_all_of_its_points_are(case: Case, clearance_cells: float) -> None:
    grid, points = case
    clearance_m = clearance_cells * grid.resolution_m
    spacing_m = 0.02 * grid.resolution_m
    least_m = maps.true_clearance(grid, maps.samples(points, spacing_m)).min()
    field = ClearanceField(grid)
    is_free = field.segment_is_free(points[0].tolist(), points[1].tolist(), clearance_m)
    if is_free:
        assert least_m >= clearance_m - 2e-8
    else:
        assert least_m < clearance_m + spacing_m
    assert field.free_segments(points, clearance_m).tolist() == [is_free]


@given(grids_with_points(n=5))
def test_the_clearance_of_a_path_is_the_least_of_all_its_points(
    case: Case,
) -> None:
    grid, path = case
    spacing_m = 0.02 * grid.resolution_m
    least_m = maps.true_clearance(grid, maps.samples(path, spacing_m)).min()
    assert least_m - spacing_m <= ClearanceField(grid).path_clearance_m(path) <= least_m + 1e-9


def test_free_and_colliding_segments_both_occur_in_random_rooms() -> None:
    rng = np.random.default_rng(1)
    verdicts = []
    for _ in range(20):
        grid = maps.random_room(rng)
        field = ClearanceField(grid)
        for a in rng.uniform(0.0, [8.0, 6.0], (20, 2)):
            b = a + rng.normal(0.0, 0.8, 2)
            verdicts.append(field.segment_is_free(a.tolist(), b.tolist(), 0.3))
            inside = maps.samples(np.stack([a, b]), 0.01)
            assert verdicts[-1] == bool((maps.true_clearance(grid, inside) >= 0.3 - 1e-8).all()) or not verdicts[-1]
    assert 0.2 < np.mean(verdicts) < 0.9


def test_no_segment_jumps_a_wall_of_one_cell() -> None:
    cells = np.zeros((3000, 3000), dtype=np.bool_)
    cells[:, 1500] = True
    field = ClearanceField(maps.grid(cells, 0.01))
    assert not field.segment_is_free((1.0, 15.005), (29.0, 15.005), 1e-6)
    assert not field.free_segments(np.array([[1.0, 15.005], [29.0, 15.005]]), 1e-6)[0]
    assert field.path_clearance_m(np.array([[1.0, 15.005], [29.0, 15.005]])) == 0.0
    assert field.segment_is_free((1.0, 15.005), (14.98, 15.005), 1e-6)


def test_the_corners_of_two_squares_that_touch_are_closed() -> None:
    field = ClearanceField(maps.grid(np.array([[0, 1], [1, 0]]), 1.0))
    assert not field.segment_is_free((0.5, 0.5), (1.5, 1.5), 1e-7)
    assert field.path_clearance_m(np.array([[0.5, 0.5], [1.5, 1.5]])) == 0.0


def test_a_segment_that_touches_the_clearance_is_free_and_a_nearer_one_is_not() -> None:
    field = ClearanceField(maps.room((0.0, 8.0, 2.0, 2.5)))
    assert field.segment_is_free((1.0, 3.0), (7.0, 3.0), 0.5)
    assert not field.segment_is_free((1.0, 3.0), (7.0, 3.0 - 1e-6), 0.5)


def test_a_map_is_separated_only_where_every_way_is_too_narrow() -> None:
    field = ClearanceField(maps.gate(1.0))
    assert not field.is_separated((1.0, 5.0), (19.0, 5.0), 0.49)
    assert field.is_separated((1.0, 5.0), (19.0, 5.0), 0.55)
    assert not field.is_separated((1.0, 5.0), (8.0, 1.0), 0.55)


@pytest.mark.parametrize("pattern", ["cells[::97, ::89]", "cells[::2, ::3]"])
def test_a_map_of_4000_by_4000_cells_takes_less_than_600_megabytes(pattern: str) -> None:
    # Not `ru_maxrss`: across fork and exec it keeps the peak of the process that runs the tests.
    script = f"""
import re
from pathlib import Path
import numpy as np
from legpush.messages.planning import OccupancyGrid
import planner_proc.planning
from planner_proc.clearance.field import ClearanceField
cells = np.zeros((4000, 4000), dtype=np.uint8)
{pattern} = 1
grid = OccupancyGrid(n_columns=4000, n_rows=4000, resolution_m=0.05, origin_m=(0.0, 0.0), cells=cells.tobytes())
del cells
field = ClearanceField(grid)
assert field.clearance_m(np.array([[0.075, 0.075]]))[0] > 0.0
field.is_separated((0.075, 0.075), (199.0, 199.0), 0.01)
peak_kb = re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1]
print(int(peak_kb) / 1024)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert float(done.stdout) < 600.0
