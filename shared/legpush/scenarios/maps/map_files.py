"""Reads occupancy maps from CSV and NumPy files; also the parts that they share with maps of ROS `map_server`."""

import csv
from dataclasses import dataclass
from importlib.resources.abc import Traversable
from io import BytesIO, StringIO
from pathlib import Path, PurePath
from tokenize import TokenError
from typing import Final
from zipfile import BadZipFile

import numpy as np

from legpush.arrays import Flags
from legpush.errors import ScenarioError
from legpush.scenarios.maps.map_formats import FirstRow, suffix_of

MAX_MAP_SIDE: Final = 4096
NO_ARRAY: Final = (ValueError, TypeError, OverflowError, OSError, EOFError, MemoryError, TokenError, BadZipFile)
"""Errors that NumPy raises for a damaged file, or a file of another kind."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OccupancyMap:
    """Square cells, (rows, columns); row 0 lies at the lowest y, column 0 at the lowest x."""

    occupied: Flags
    """Occupied or unknown cells."""
    unknown: Flags
    """Cells that the file calls neither occupied nor free."""
    cell_m: float
    origin_m: tuple[float, float] = (0.0, 0.0)
    """Lower left corner of the map in the file's own frame; in the room, this corner is (0, 0)."""

    @property
    def size_m(self) -> tuple[float, float]:
        """Extent along x and y."""
        n_rows, n_columns = self.occupied.shape
        return n_columns * self.cell_m, n_rows * self.cell_m


def read_cells(source: Traversable, cell_m: float, first_row: FirstRow) -> OccupancyMap:
    """Return the map in a CSV or NumPy file.

    Raises:
        ScenarioError: The file cannot be used; names the file, and the row and column that are wrong.
    """
    try:
        content = source.read_bytes()
    except OSError as error:
        raise ScenarioError(f"{source}: expected a readable grid file ({error.strerror})") from error
    read = _read_csv if suffix_of(source.name) == ".csv" else _read_npy
    occupied = read(content, str(source))
    if first_row == "top":
        occupied = occupied[::-1]
    return OccupancyMap(occupied=occupied, unknown=np.zeros_like(occupied), cell_m=cell_m)


def file_inside(folder: Traversable, name: str, where: str) -> Traversable:
    """Return the file that another file of `folder` names; it lies in this folder or below it.

    Raises:
        ScenarioError: The name leads out of the folder, by `..`, as an absolute path or by a link; begins with `where`.
    """
    path = PurePath(name)
    stays = ".." not in path.parts and "\0" not in name
    if isinstance(folder, Path):
        stays = stays and (folder / path).resolve().is_relative_to(folder.resolve())
    if not stays or (path.is_absolute() and not isinstance(folder, Path)):
        raise ScenarioError(f"{where}: expected a file beside this one or in a folder below it, got {name!r}")
    if isinstance(folder, Path) and (folder / path).exists() and not (folder / path).is_file():
        raise ScenarioError(f"{where}: expected a file, got {name!r}, which is something else")
    return folder / name


def require_side(n_rows: int, n_columns: int, where: str) -> None:
    """Check that a map has cells, and not too many.

    Raises:
        ScenarioError: It has none, or too many.
    """
    if not (1 <= n_rows <= MAX_MAP_SIDE and 1 <= n_columns <= MAX_MAP_SIDE):
        size = f"{n_rows} rows of {n_columns}" if n_rows and n_columns else "none"
        raise ScenarioError(f"{where}: expected 1 to {MAX_MAP_SIDE} rows and columns of cells, got {size}")


def _read_csv(content: bytes, where: str) -> Flags:
    """Return the cells in the order of the file, (rows, columns)."""
    try:
        rows = [row for row in csv.reader(StringIO(content.decode("utf-8"))) if row]
    except (UnicodeDecodeError, csv.Error) as error:
        raise ScenarioError(f"{where}: expected a CSV file in UTF-8 ({error})") from error
    require_side(len(rows), len(rows[0]) if rows else 0, where)
    for number, row in enumerate(rows, start=1):
        if len(row) != len(rows[0]):
            raise ScenarioError(f"{where}: expected {len(rows[0])} cells in row {number} as in row 1, got {len(row)}")
        for column, cell in enumerate(row, start=1):
            if cell.strip() not in ("0", "1"):
                raise ScenarioError(f"{where}: expected 0 or 1 in row {number}, column {column}, got `{cell}`")
    return np.array([[cell.strip() == "1" for cell in row] for row in rows])


def _read_npy(content: bytes, where: str) -> Flags:
    """Return the cells in the order of the file, (rows, columns)."""
    try:
        cells = np.load(BytesIO(content), allow_pickle=False)
    except NO_ARRAY as error:
        raise ScenarioError(f"{where}: expected a NumPy file of one array without pickled objects ({error})") from error
    if not isinstance(cells, np.ndarray) or cells.ndim != 2:
        got = f"{cells.ndim} dimensions" if isinstance(cells, np.ndarray) else "an archive of arrays"
        raise ScenarioError(f"{where}: expected an array of 2 dimensions, rows and columns, got {got}")
    if cells.dtype.kind not in "biu":
        raise ScenarioError(f"{where}: expected an array of integers or truth values, got {cells.dtype}")
    n_rows, n_columns = cells.shape
    require_side(n_rows, n_columns, where)
    wrong = np.argwhere((cells != 0) & (cells != 1))
    if len(wrong):
        row, column = wrong[0]
        raise ScenarioError(
            f"{where}: expected 0 or 1 in row {row + 1}, column {column + 1}, got `{cells[row, column]}`"
        )
    return cells.astype(np.bool_)
