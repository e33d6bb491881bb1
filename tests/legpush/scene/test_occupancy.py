"""The occupancy map of a room."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace
from numpy.typing import NDArray

from legpush.geometry import Pose2
from legpush.scene.footprints import Footprint, distance_m
from legpush.scene.occupancy import OccupancyGrid, clearance_m, grid_shape, occupancy_grid, room_by_now
from legpush.scene.plan_settings import PlanSettings
from legpush.scene.scenario import Rectangle, Room
from tests.legpush.examples import SCENARIO
from tests.legpush.scene.floor_shapes import FOOTPRINT, samples_in
from tests.robots import CIRCLE_M, scaled_robot


def cells_of(grid: OccupancyGrid) -> NDArray[np.uint8]:
    """(rows, columns)."""
    return np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)


@given(footprint=FOOTPRINT, resolution_m=st.sampled_from([0.05, 0.1, 0.3]))
def test_every_cell_with_a_point_of_the_footprint_is_occupied(footprint: Footprint, resolution_m: float) -> None:
    room = Room(size_m=(5.0, 4.0), resolution_m=resolution_m)
    cells = cells_of(occupancy_grid(room, (footprint,)))
    points = samples_in(footprint)
    points = points[((points > 0.0) & (points < room.size_m)).all(axis=1)]
    columns, rows = (points / resolution_m).astype(int).T
    assert cells[rows, columns].all()


@given(footprint=FOOTPRINT)
def test_no_cell_that_lies_wholly_outside_the_footprint_is_occupied(footprint: Footprint) -> None:
    room = Room(size_m=(5.0, 4.0), resolution_m=0.1)
    occupied = np.argwhere(cells_of(occupancy_grid(room, (footprint,))))
    for row, column in occupied:
        cell = Footprint(
            pose=Pose2(x_m=(column + 0.5) * 0.1, y_m=(row + 0.5) * 0.1, yaw_rad=0.0), length_m=0.1, width_m=0.1
        )
        assert distance_m(cell, footprint) <= 0.0


def test_walls_along_cell_borders_occupy_exactly_their_cells() -> None:
    wall = Rectangle(x_min_m=0.3, x_max_m=0.6, y_min_m=0.7, y_max_m=0.8)
    cells = cells_of(occupancy_grid(Room(size_m=(2.0, 1.0), resolution_m=0.1, obstacles=(wall,))))
    assert cells.shape == (10, 20)
    assert np.argwhere(cells).tolist() == [[7, 3], [7, 4], [7, 5]]


def test_a_room_has_by_now_what_was_there_and_what_has_appeared() -> None:
    walls = tuple(
        Rectangle(x_min_m=x_m, x_max_m=x_m + 0.5, y_min_m=0.0, y_max_m=1.0, appears_at_s=at_s)
        for x_m, at_s in ((0.0, 0.0), (1.0, 4.0), (2.0, 2.0))
    )
    room = Room(size_m=(4.0, 2.0), obstacles=walls)

    assert room_by_now(room, ()).obstacles == walls[:1]
    assert room_by_now(room, {2}).obstacles == (walls[0], walls[2])
    assert room_by_now(room, (2, 1)) == room
    assert cells_of(occupancy_grid(room_by_now(room, {2}))).sum() == 2 * 10 * 20


def test_row_0_lies_at_the_lowest_y() -> None:
    wall = Rectangle(x_min_m=0.0, x_max_m=2.0, y_min_m=0.0, y_max_m=0.1)
    cells = cells_of(occupancy_grid(Room(size_m=(2.0, 1.0), resolution_m=0.1, obstacles=(wall,))))
    assert cells[0].all()
    assert not cells[1:].any()


def test_a_wall_that_touches_half_a_cell_occupies_it() -> None:
    wall = Rectangle(x_min_m=0.35, x_max_m=0.55, y_min_m=0.5, y_max_m=0.6)
    cells = cells_of(occupancy_grid(Room(size_m=(1.0, 1.0), resolution_m=0.1, obstacles=(wall,))))
    assert np.flatnonzero(cells[5]).tolist() == [3, 4, 5]


def test_cells_that_reach_beyond_the_room_are_occupied() -> None:
    cells = cells_of(occupancy_grid(Room(size_m=(0.95, 0.82), resolution_m=0.1)))
    assert cells.shape == (9, 10)
    assert cells[8].all()
    assert cells[:, 9].all()
    assert not cells[:8, :9].any()


@given(n=st.integers(1, 400), resolution_m=st.sampled_from([0.05, 0.1, 0.07, 1 / 3]))
def test_a_whole_number_of_cells_makes_no_further_one(n: int, resolution_m: float) -> None:
    room = Room(size_m=(n * resolution_m, resolution_m), resolution_m=resolution_m)
    assert grid_shape(room) == (n, 1)
    assert not cells_of(occupancy_grid(room)).any()


def test_the_clearance_is_the_foot_rectangles_radius_and_the_margin() -> None:
    wide = replace(SCENARIO, planning=PlanSettings(margin_m=0.2))
    assert clearance_m(SCENARIO) == pytest.approx(CIRCLE_M + 0.1) == pytest.approx(0.442, abs=0.001)
    assert clearance_m(wide) == pytest.approx(CIRCLE_M + 0.2)
    small = replace(SCENARIO, robot=scaled_robot(0.5))
    assert clearance_m(small) == pytest.approx(CIRCLE_M / 2 + 0.1)
