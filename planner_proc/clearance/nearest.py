"""For each grid cell, the nearest occupied cell, computed on demand.

A coarse pass over blocks of cells gives a lower bound for every distance. Where it does not answer a question, one tile
of cells is computed exactly, from a window that reaches beyond it. When much of the grid has been asked for, the whole
grid is computed at once. Lengths are cells.
"""

from collections.abc import Iterator
from math import sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from legpush.arrays import Flags, Floats, Integers

_BLOCK: Final = 8
"""Side of a block."""
_SHIFT: Final = 3
"""A cell's row or column, shifted right by this many bits, is that of its block."""
_ROWS_AT_ONCE: Final = 256
"""How many rows of cells to measure at once, to save memory."""
_WORTH_ALL: Final = 0.5
"""Compute the whole grid once the windows of the tiles add up to more than this share of its cells."""
_DIAGONAL: Final = sqrt(2.0)
_FLOAT32: Final = 1.0 - 1e-6
"""Factor by which lower bounds shrink, so that rounding them to 32 bits does not raise them."""
_NONE: Final = -1e-3
"""Stands for a bound of 0, because 0 marks a bound that is not known yet."""


class NearestCells:
    """Nearest occupied cells, exact up to `reach` cells between centres; farther away, some occupied cell."""

    def __init__(self, occupied: Flags, reach: int) -> None:
        """Take a map, (rows, columns), whose outermost cells are occupied."""
        self._occupied = occupied
        self._reach = reach
        self._tile = 2 * reach
        n_rows, n_columns = occupied.shape
        self._n_columns = n_columns
        # Pages of zeros take no memory before something is written to them.
        self._squares = np.zeros((2, n_rows * n_columns), dtype=np.int32)
        """Row and column of the occupied cell nearest to each cell, (2, rows * columns)."""
        self._flat_squares = self._squares.data
        self._bounds = np.zeros(n_rows * n_columns, dtype=np.float32)
        """Lower bound of the distance of all points of each cell, (rows * columns,); 0 if it is not known yet."""
        self._flat_bounds = self._bounds.data
        self._blocks_per_row = -(-n_columns // _BLOCK)
        self._solid_blocks = _any_in_blocks(occupied)
        rows, columns = ndimage.distance_transform_edt(~self._solid_blocks, return_distances=False, return_indices=True)
        up, across = rows - np.arange(len(rows))[:, None], columns - np.arange(self._blocks_per_row)
        self._nearest_blocks = np.stack([rows.ravel(), columns.ravel()])
        apart = np.sqrt((up * up + across * across).ravel().astype(np.float64))
        # Two points are nearer to each other than the centres of their blocks by at most a block's diagonal.
        self._coarse = (np.maximum(apart - _DIAGONAL, 0.0) * (_BLOCK * _FLOAT32)).astype(np.float32)
        self._flat_coarse = self._coarse.data
        self._window_cells = 0
        self._is_complete = False

    def bound(self, row: int, column: int, enough: float) -> float:
        """Lower bound of the distance from any point of a cell to the occupied cells.

        It is too low by about a cell, and by more where it exceeds `enough`. A negative bound stands for 0.
        """
        index = row * self._n_columns + column
        bound: float = self._flat_bounds[index]
        if bound == 0.0:
            coarse: float = self._flat_coarse[(row >> _SHIFT) * self._blocks_per_row + (column >> _SHIFT)]
            if coarse > enough:
                return coarse
            self._work_out([(row // self._tile, column // self._tile)])
            bound = self._flat_bounds[index]
        return bound

    def bounds(self, rows: Integers, columns: Integers, enough: Floats | float) -> Floats:
        """The same as `bound` for many cells, (n,), and never below 0."""
        index = rows * self._n_columns + columns
        bounds = self._bounds.take(index)
        if (unknown := bounds == 0.0).any():
            coarse = self._coarse.take((rows >> _SHIFT) * self._blocks_per_row + (columns >> _SHIFT))
            if (unsure := unknown & (coarse <= enough)).any():
                self._work_out(self._tiles(rows[unsure], columns[unsure]))
                bounds = self._bounds.take(index)
            bounds = np.where(bounds == 0.0, coarse, bounds)
        known: Floats = np.maximum(bounds, 0.0, dtype=np.float64)
        return known

    def square(self, row: int, column: int) -> tuple[int, int]:
        """Row and column of the occupied cell nearest to a cell."""
        index = row * self._n_columns + column
        if self._flat_bounds[index] == 0.0:
            self._work_out([(row // self._tile, column // self._tile)])
        return self._flat_squares[0, index], self._flat_squares[1, index]

    def squares(self, rows: Integers, columns: Integers) -> NDArray[np.int32]:
        """Rows and columns of the occupied cells nearest to many cells, (2, n)."""
        index = rows * self._n_columns + columns
        if (unknown := self._bounds.take(index) == 0.0).any():
            self._work_out(self._tiles(rows[unknown], columns[unknown]))
        squares: NDArray[np.int32] = self._squares.take(index, axis=1)
        return squares

    def centre_distances(self) -> Iterator[tuple[slice, Floats]]:
        """Exact distances from the centres of all cells to the nearest occupied one, for some rows at a time.

        Yields the rows, and the distances, (rows, columns).
        """
        self._complete()
        n_rows, n_columns = self._occupied.shape
        squares = self._squares.reshape(2, n_rows, n_columns)
        for first in range(0, n_rows, _ROWS_AT_ONCE):
            rows = slice(first, min(first + _ROWS_AT_ONCE, n_rows))
            yield rows, _distances(squares[:, rows], rows.start, 0)

    def _tiles(self, rows: Integers, columns: Integers) -> list[tuple[int, int]]:
        """Rows and columns of the tiles that hold some cells, without repetition."""
        n = self._n_columns // self._tile + 1
        return [divmod(tile, n) for tile in set((rows // self._tile * n + columns // self._tile).tolist())]

    def _work_out(self, tiles: list[tuple[int, int]]) -> None:
        """Fill some tiles, or the whole grid if the tiles have become too many."""
        size = self._tile
        self._window_cells += len(tiles) * (2 * size) ** 2
        if self._window_cells > _WORTH_ALL * self._occupied.size:
            self._complete()
            return
        for row, column in tiles:
            self._fill(row * size, column * size)

    def _fill(self, bottom: int, left: int) -> None:
        """Fill the tile that begins at a row and a column, from the occupied cells within reach of it."""
        n_rows, n_columns = self._occupied.shape
        top, right = min(bottom + self._tile, n_rows), min(left + self._tile, n_columns)
        first_row, first_column = max(bottom - self._reach, 0), max(left - self._reach, 0)
        window = self._occupied[first_row : top + self._reach, first_column : right + self._reach]
        inner = (slice(bottom - first_row, top - first_row), slice(left - first_column, right - first_column))
        rows, columns = np.arange(bottom, top), np.arange(left, right)
        blocks = (rows >> _SHIFT)[:, None] * self._blocks_per_row + (columns >> _SHIFT)
        bounds = self._coarse[blocks].astype(np.float64)
        if window.any():
            nearest = ndimage.distance_transform_edt(~window, return_distances=False, return_indices=True)
            squares = nearest[(slice(None), *inner)] + np.array([first_row, first_column])[:, None, None]
            apart = np.minimum(_distances(squares, bottom, left), float(self._reach))
            bounds = np.maximum(bounds, _below(apart))
        else:
            middle = blocks[len(blocks) // 2, blocks.shape[1] // 2]
            squares = np.array(self._some_cell(int(middle)))[:, None, None]
            bounds = np.maximum(bounds, _below(np.array(float(self._reach))))
        bounds[bounds == 0.0] = _NONE
        self._bounds.reshape(n_rows, n_columns)[bottom:top, left:right] = bounds
        self._squares.reshape(2, n_rows, n_columns)[:, bottom:top, left:right] = squares

    def _some_cell(self, block: int) -> tuple[int, int]:
        """Row and column of an occupied cell in the occupied block that is nearest to a block."""
        bottom, left = (self._nearest_blocks[:, block] * _BLOCK).tolist()
        row, column = np.argwhere(self._occupied[bottom : bottom + _BLOCK, left : left + _BLOCK])[0].tolist()
        return bottom + row, left + column

    def _complete(self) -> None:
        """Fill the whole grid."""
        if self._is_complete:
            return
        self._is_complete = True
        shape = self._occupied.shape
        self._squares = ndimage.distance_transform_edt(~self._occupied, return_distances=False, return_indices=True)
        self._squares = self._squares.reshape(2, -1)
        self._flat_squares = self._squares.data
        for rows, distances in self.centre_distances():
            bounds = _below(distances)
            bounds[bounds == 0.0] = _NONE
            self._bounds.reshape(shape)[rows] = bounds


def _below(apart: Floats) -> Floats:
    """Lower bounds of the distances between the squares of cells whose centres are `apart`.

    Squares are nearer to each other than their centres by at most two half diagonals.
    """
    below: Floats = np.maximum(apart - _DIAGONAL, 0.0) * _FLOAT32
    return below


def _distances(squares: NDArray[np.integer], bottom: int, left: int) -> Floats:
    """Distances, (rows, columns), from the cells of a part of the grid to one given cell each, (2, rows, columns).

    The part begins at row `bottom` and column `left`. Distances are those between centres.
    """
    n_rows, n_columns = squares.shape[1:]
    up = squares[0] - np.arange(bottom, bottom + n_rows, dtype=np.float64)[:, None]
    across = squares[1] - np.arange(left, left + n_columns, dtype=np.float64)
    distances: Floats = np.sqrt(up * up + across * across)
    return distances


def _any_in_blocks(occupied: Flags) -> Flags:
    """Which blocks have an occupied cell, (rows, columns) of blocks; cells beyond the grid count as occupied."""
    n_rows, n_columns = (-(-n // _BLOCK) for n in occupied.shape)
    whole = np.ones((n_rows * _BLOCK, n_columns * _BLOCK), dtype=np.bool_)
    whole[: occupied.shape[0], : occupied.shape[1]] = occupied
    # Eight cells in a row are read as one 64-bit number.
    by_rows = whole.view(np.uint64).reshape(n_rows, _BLOCK, n_columns) != 0
    in_blocks: Flags = by_rows.any(axis=1)
    return in_blocks
