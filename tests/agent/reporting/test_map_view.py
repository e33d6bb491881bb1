"""What is read for `legpush map`, and what it says about a map."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agent_proc.reporting.map_view import MapView, read_view
from legpush.errors import LegpushError
from legpush.options.maps import MapOptions
from legpush.scenarios.file import load_scenario
from legpush.scene.occupancy import occupancy_grid
from tests.legpush.scenarios.map_examples import CELLS, UNKNOWN, grey_of, write_csv, write_png, write_yaml


def view_of(file: str | Path, **flags: Any) -> MapView:
    return read_view(MapOptions(file=str(file), **flags))


@pytest.mark.parametrize("first_row", ["top", "bottom"])
def test_row_0_of_the_cells_is_the_lowest_one(tmp_path: Path, first_row: str) -> None:
    write_csv(tmp_path / "map.csv", CELLS)
    view = view_of(tmp_path / "map.csv", cell_m=0.5, first_row=first_row)

    np.testing.assert_array_equal(view.occupied, CELLS[::-1] if first_row == "top" else CELLS)
    assert (view.size_m, view.resolution_m, view.scenario) == ((8.0, 5.0), 0.5, None)


def test_a_map_of_ros_says_where_its_frame_is_and_what_is_unknown(tmp_path: Path) -> None:
    grey = grey_of(CELLS)
    grey[-2:, -4:] = UNKNOWN
    write_png(tmp_path / "map.png", grey)
    write_yaml(tmp_path / "map.yaml", image="map.png", origin=[-4.0, -2.5, 0.0])

    assert view_of(tmp_path / "map.yaml").lines() == [
        "size        8 x 5 m",
        "cells       16 x 10 of 0.5 m",
        "origin      (0, 0) is the lower left corner, x to the right, y up",
        "map frame   the room's plus (-4, -2.5): there the corner is (-4, -2.5)",
        "occupied    9.4% of the cells, in 5 rectangles",
        "unknown     5.0% of the file's cells, which count as occupied",
    ]


def test_a_map_of_too_many_rectangles_is_shown_and_said_to_be_no_room(tmp_path: Path) -> None:
    cells = np.zeros((202, 202), dtype=np.bool_)
    cells[::2, ::2] = True
    np.save(tmp_path / "map.npy", cells)
    view = view_of(tmp_path / "map.npy", cell_m=0.05, first_row="top")

    assert view.lines()[-1].endswith("25.0% of the cells, in 10201 rectangles: more than the 10000 of a room")


def test_of_a_scenario_it_is_the_grid_of_the_planner() -> None:
    scenario = load_scenario("default")
    view, grid = view_of("default"), occupancy_grid(scenario.room)

    assert view.occupied.tobytes() == grid.cells
    assert (view.occupied.shape, view.resolution_m) == ((grid.n_rows, grid.n_columns), grid.resolution_m)
    assert (view.scenario, view.n_walls, view.source) == (scenario, len(scenario.room.obstacles), None)


def test_a_map_that_cannot_be_read_is_refused_with_its_name(tmp_path: Path) -> None:
    (tmp_path / "map.yaml").write_text("image: map.pgm")

    with pytest.raises(LegpushError, match=r"map\.yaml: at `resolution`: expected a value, got nothing"):
        view_of(tmp_path / "map.yaml")
