"""Rooms from a grid of cells in a CSV file: its walls as few rectangles."""

import csv
from importlib.resources.abc import Traversable
from io import StringIO
from typing import Annotated, Final, Literal

import numpy as np
from msgspec import Meta, Struct
from msgspec.structs import fields
from numpy.typing import NDArray

from legpush.errors import ScenarioError
from legpush.scenario import Positive, Rectangle

MAX_GRID_SIDE: Final = 4096


class GridSource(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The fields of `[room]` that stand for its size and walls."""

    grid_file: Annotated[str, Meta(min_length=1)]
    """CSV file beside the scenario file: one line per row, one number per cell, 0 free, 1 wall."""
    cell_m: Positive
    """Side of a cell."""
    first_row: Literal["top", "bottom"]
    """Where the first line of the file lies: at the highest y, as MATLAB reads a map, or at y = 0."""


GRID_FIELDS: Final = tuple(field.name for field in fields(GridSource))


def read_grid(grid: GridSource, folder: Traversable) -> tuple[tuple[float, float], tuple[Rectangle, ...]]:
    """Size of the room and its walls; `ScenarioError` names the file, row and column that is wrong."""
    source = folder / grid.grid_file
    try:
        text = source.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{source}: expected a readable grid file of `room.grid_file` ({error})") from error
    occupied = _parse(text, str(source))
    if grid.first_row == "top":
        occupied = occupied[::-1]
    n_rows, n_columns = occupied.shape
    return (n_columns * grid.cell_m, n_rows * grid.cell_m), merged_rectangles(occupied, grid.cell_m)


def merged_rectangles(occupied: NDArray[np.bool_], cell_m: float) -> tuple[Rectangle, ...]:
    """Rectangles that cover exactly the occupied cells, (rows, columns), row 0 at y = 0, without overlapping.

    Cells side by side in a row make a run; equal runs of rows one above the other make a rectangle.
    """
    rectangles = []
    open_runs: dict[tuple[int, int], int] = {}
    for row in range(len(occupied) + 1):
        runs = _runs(occupied[row]) if row < len(occupied) else []
        for (first, last), first_row in list(open_runs.items()):
            if (first, last) not in runs:
                rectangles.append(
                    Rectangle(
                        x_min_m=first * cell_m, x_max_m=last * cell_m, y_min_m=first_row * cell_m, y_max_m=row * cell_m
                    )
                )
                del open_runs[first, last]
        for run in runs:
            open_runs.setdefault(run, row)
    return tuple(rectangles)


def _runs(row: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First column of each stretch of occupied cells and the column after its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]])))
    return [(int(first), int(last)) for first, last in edges.reshape(-1, 2)]


def _parse(text: str, where: str) -> NDArray[np.bool_]:
    """Cells as in the file, (rows, columns)."""
    rows = [row for row in csv.reader(StringIO(text)) if row]
    if not rows or len(rows) > MAX_GRID_SIDE or len(rows[0]) > MAX_GRID_SIDE:
        size = f"{len(rows)} rows of {len(rows[0])}" if rows else "none"
        raise ScenarioError(f"{where}: expected 1 to {MAX_GRID_SIDE} rows and columns of cells, got {size}")
    for number, row in enumerate(rows, start=1):
        if len(row) != len(rows[0]):
            raise ScenarioError(f"{where}: expected {len(rows[0])} cells in row {number} as in row 1, got {len(row)}")
        for column, cell in enumerate(row, start=1):
            if cell.strip() not in ("0", "1"):
                raise ScenarioError(f"{where}: expected 0 or 1 in row {number}, column {column}, got `{cell}`")
    return np.array([[cell.strip() == "1" for cell in row] for row in rows])
