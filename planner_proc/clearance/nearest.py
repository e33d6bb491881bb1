"""Of each cell of a grid the occupied cell that is nearest to it, worked out only where somebody asks.

A coarse pass over blocks of cells bounds all distances from below. Where that does not answer a question, one tile of
cells is worked out exactly, from a window that reaches beyond it; where much of the grid is asked for, all of it at
once. Lengths are cells.
"""

from collections.abc import Iterator
from math import sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from legpush.arrays import Flags, Floats, Integers

_BLOCK: Final = 8
_SHIFT: Final = 3
"""A cell's row or column, shifted so, is that of its block."""
_ROWS_AT_ONCE: Final = 256
_WORTH_ALL: Final = 0.5
"""Of the grid's cells: when the windows of the tiles would come to more, the whole grid is worked out instead."""
_DIAGONAL: Final = sqrt(2.0)
_FLOAT32: Final = 1.0 - 1e-6
"""What rounding a bound to 32 bits may add to it."""
_NONE: Final = -1e-3
"""A bound of nothing, told apart from one that is not known yet."""


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
        """Row and column of the one that is nearest to each cell, (2, rows * columns)."""
        self._flat_squares = self._squares.data
        self._bounds = np.zeros(n_rows * n_columns, dtype=np.float32)
        """What no point of each cell is nearer than, (rows * columns,); 0 where that is not known yet."""
        self._flat_bounds = self._bounds.data
        self._blocks_per_row = -(-n_columns // _BLOCK)
        self._solid_blocks = _any_in_blocks(occupied)
        rows, columns = ndimage.distance_transform_edt(~self._solid_blocks, return_distances=False, return_indices=True)
        up, across = rows - np.arange(len(rows))[:, None], columns - np.arange(self._blocks_per_row)
        self._nearest_blocks = np.stack([rows.ravel(), columns.ravel()])
        apart = np.sqrt((up * up + across * across).ravel().astype(np.float64))
        # Two points are nearer than the centres of their blocks by at most a diagonal.
        self._coarse = (np.maximum(apart - _DIAGONAL, 0.0) * (_BLOCK * _FLOAT32)).astype(np.float32)
        self._flat_coarse = self._coarse.data
        self._window_cells = 0
        self._is_complete = False

    def bound(self, row: int, column: int, enough: float) -> float:
        """What the distance of no point of the cell is below; exact to a cell unless it is more than `enough`."""
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
        """The same of many cells, (n,)."""
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
        """Row and column of the occupied cell that is nearest to a cell."""
        index = row * self._n_columns + column
        if self._flat_bounds[index] == 0.0:
            self._work_out([(row // self._tile, column // self._tile)])
        return self._flat_squares[0, index], self._flat_squares[1, index]

    def squares(self, rows: Integers, columns: Integers) -> NDArray[np.int32]:
        """Rows and columns of those nearest to many cells, (2, n)."""
        index = rows * self._n_columns + columns
        if (unknown := self._bounds.take(index) == 0.0).any():
            self._work_out(self._tiles(rows[unknown], columns[unknown]))
        squares: NDArray[np.int32] = self._squares.take(index, axis=1)
        return squares

    def centre_distances(self) -> Iterator[tuple[slice, Floats]]:
        """Exact distances from all cells' centres to the nearest occupied ones, some rows at a time to save memory."""
        self._complete()
        n_rows, n_columns = self._occupied.shape
        squares = self._squares.reshape(2, n_rows, n_columns)
        for first in range(0, n_rows, _ROWS_AT_ONCE):
            rows = slice(first, min(first + _ROWS_AT_ONCE, n_rows))
            yield rows, _distances(squares[:, rows], rows.start, 0)

    def _tiles(self, rows: Integers, columns: Integers) -> list[tuple[int, int]]:
        """Rows and columns of the tiles in which some cells are, (n,)."""
        n = self._n_columns // self._tile + 1
        return [divmod(tile, n) for tile in set((rows // self._tile * n + columns // self._tile).tolist())]

    def _work_out(self, tiles: list[tuple[int, int]]) -> None:
        """Fill some tiles, or everything."""
        size = self._tile
        self._window_cells += len(tiles) * (2 * size) ** 2
        if self._window_cells > _WORTH_ALL * self._occupied.size:
            self._complete()
            return
        for row, column in tiles:
            self._fill(row * size, column * size)

    def _fill(self, bottom: int, left: int) -> None:
        """One tile, from all that is within reach of it."""
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
        """The whole grid."""
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
    """Bounds on how near the squares of two cells are whose centres are so far apart.

    They are nearer by at most both half diagonals.
    """
    below: Floats = np.maximum(apart - _DIAGONAL, 0.0) * _FLOAT32
    return below


def _distances(squares: NDArray[np.integer], bottom: int, left: int) -> Floats:
    """Between the centres of the cells of a part of the grid and given ones, (2, rows, columns)."""
    n_rows, n_columns = squares.shape[1:]
    up = squares[0] - np.arange(bottom, bottom + n_rows, dtype=np.float64)[:, None]
    across = squares[1] - np.arange(left, left + n_columns, dtype=np.float64)
    distances: Floats = np.sqrt(up * up + across * across)
    return distances


def _any_in_blocks(occupied: Flags) -> Flags:
    """Which blocks have an occupied cell; what a block has beyond the grid is occupied."""
    n_rows, n_columns = (-(-n // _BLOCK) for n in occupied.shape)
    whole = np.ones((n_rows * _BLOCK, n_columns * _BLOCK), dtype=np.bool_)
    whole[: occupied.shape[0], : occupied.shape[1]] = occupied
    # Eight cells in a row are read as one number.
    by_rows = whole.view(np.uint64).reshape(n_rows, _BLOCK, n_columns) != 0
    in_blocks: Flags = by_rows.any(axis=1)
    return in_blocks
