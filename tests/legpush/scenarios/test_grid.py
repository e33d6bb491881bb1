"""Rooms from grids of cells, and cells merged into rectangles."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.bounds import MAX_OVERLAP
from legpush.errors import ScenarioError
from legpush.scenarios.file import load_scenario
from legpush.scenarios.grid import merged_rectangles
from legpush.scene.scenario import Rectangle
from tests.legpush.scenarios.small_scenario import plain_scenario, write


@given(data=st.data(), n_rows=st.integers(1, 12), n_columns=st.integers(1, 12))
def test_merged_rectangles_cover_exactly_the_occupied_cells_once(
    data: st.DataObject, n_rows: int, n_columns: int
) -> None:
    bits = data.draw(st.lists(st.booleans(), min_size=n_rows * n_columns, max_size=n_rows * n_columns))
    occupied = np.array(bits).reshape(n_rows, n_columns)
    covered = np.zeros_like(occupied, dtype=int)
    for r in merged_rectangles(occupied, 0.5):
        covered[round(r.y_min_m * 2) : round(r.y_max_m * 2), round(r.x_min_m * 2) : round(r.x_max_m * 2)] += 1
    assert (covered == occupied).all()


def test_a_solid_block_of_cells_is_one_rectangle() -> None:
    assert merged_rectangles(np.ones((3, 4), dtype=bool), 2.0) == (
        Rectangle(x_min_m=0.0, x_max_m=8.0, y_min_m=0.0, y_max_m=6.0),
    )


def grid_scenario(folder: Path, cells: str, **room: Any) -> Path:
    """The small scenario with its room from a grid; `room` replaces fields of the room, None drops one."""
    (folder / "cells.csv").write_text(cells)
    plain = plain_scenario()
    fields = {"grid_file": "cells.csv", "cell_m": 1.0, "first_row": "top"} | room
    plain["room"] = {key: value for key, value in fields.items() if value is not None}
    return write(folder, plain)


CELLS = "1,1,0,0,0,0,0,0\n" + "0,0,0,0,0,0,0,0\n" * 4


@pytest.mark.parametrize(("first_row", "y_min_m"), [("top", 4.0), ("bottom", 0.0)])
def test_the_first_row_lies_where_the_file_says(first_row: str, y_min_m: float, tmp_path: Path) -> None:
    path = grid_scenario(tmp_path, CELLS, first_row=first_row)
    if first_row == "bottom":
        path.write_text(path.read_text().replace("y_m = 1.0", "y_m = 3.0"))
    room = load_scenario(path).room
    assert room.size_m == (8.0, 5.0)
    assert room.obstacles == (Rectangle(x_min_m=0.0, x_max_m=2.0, y_min_m=y_min_m, y_max_m=y_min_m + 1.0),)


def test_obstacles_may_be_added_to_a_grid(tmp_path: Path) -> None:
    extra = {"x_min_m": 3.0, "x_max_m": 3.2, "y_min_m": 0.0, "y_max_m": 2.0}
    room = load_scenario(grid_scenario(tmp_path, CELLS, obstacles=[extra])).room
    assert [r.x_min_m for r in room.obstacles] == [3.0, 0.0]


@pytest.mark.parametrize(
    ("cells", "room", "words"),
    [
        (
            CELLS,
            {"first_row": "up"},
            r"small\.toml:\d+: at `room\.first_row`: expected one of bottom, top, got 'up'",
        ),
        (CELLS, {"first_row": None}, r"small\.toml:\d+: at `room\.first_row`: expected a value, got nothing"),
        (CELLS, {"grid_file": None}, r"small\.toml:\d+: at `room\.grid_file`: expected a value, got nothing"),
        (
            CELLS,
            {"cell_m": 0.0},
            r"small\.toml:\d+: at `room\.cell_m`: expected a number from 0\.001 to 100, got 0\.0",
        ),
        (
            CELLS,
            {"size_m": [8.0, 5.0]},
            r"small\.toml:\d+: at `room\.size_m`: expected nothing, since `room\.grid_file`",
        ),
        (CELLS, {"obstacles": 3}, r"small\.toml:\d+: at `room\.obstacles`: expected an array, got a whole number 3"),
        (CELLS, {"grid_file": "no.csv"}, r"no\.csv: expected a readable grid file"),
        ("", {}, r"cells\.csv: expected 1 to 4096 rows and columns of cells, got none"),
        ("0,0\n0\n", {}, r"cells\.csv: expected 2 cells in row 2 as in row 1, got 1"),
        ("0,0\n0,2\n", {}, r"cells\.csv: expected 0 or 1 in row 2, column 2, got `2`"),
        ("0,0\n0,nan\n", {}, r"cells\.csv: expected 0 or 1 in row 2, column 2, got `nan`"),
    ],
)
def test_a_bad_grid_is_refused_with_file_row_and_column(
    cells: str, room: dict[str, Any], words: str, tmp_path: Path
) -> None:
    with pytest.raises(ScenarioError, match=words):
        load_scenario(grid_scenario(tmp_path, cells, **room))


def test_the_walls_of_a_grid_count_in_the_overlap(tmp_path: Path) -> None:
    extra = {"x_min_m": 0.5, "x_max_m": 0.6, "y_min_m": 4.5, "y_max_m": 4.6}
    load_scenario(grid_scenario(tmp_path, CELLS, obstacles=(MAX_OVERLAP - 1) * [extra]))
    with pytest.raises(
        ScenarioError,
        match=rf"small\.toml:\d+: at `room`: .* at most {MAX_OVERLAP} obstacles that overlap .* {MAX_OVERLAP + 1}, "
        rf"with the cells of `cells\.csv` in `room\.obstacles\[{MAX_OVERLAP}\]` and later ones",
    ):
        load_scenario(grid_scenario(tmp_path, CELLS, obstacles=MAX_OVERLAP * [extra]))


def test_a_map_that_makes_the_room_too_large_is_refused_with_its_name(tmp_path: Path) -> None:
    with pytest.raises(
        ScenarioError,
        match=r"small\.toml:\d+: at `room\.size_m\[\d\]`: expected a number from 1e-06 to 1000, .*, from `cells\.csv`",
    ):
        load_scenario(grid_scenario(tmp_path, "0," * 10 + "0\n", cell_m=100.0))
