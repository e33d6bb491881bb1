"""Exact distances to unit squares: square (column, row) spans from there to (column + 1, row + 1)."""

from math import inf
from typing import Final

import numpy as np
from numpy.typing import NDArray

from legpush.arrays import Floats

AnyIntegers = NDArray[np.integer]
"""Integers of any width, of any shape."""

_CORNERS_X: Final = np.array([[0.0], [0.0], [1.0], [1.0]])
_CORNERS_Y: Final = np.array([[0.0], [1.0], [0.0], [1.0]])


def point_square_offsets(points: Floats, squares: AnyIntegers) -> Floats:
    """Shortest vectors from squares, (n, 2), to points, (n, 2), one each, (n, 2); zero inside."""
    offsets: Floats = points - np.minimum(np.maximum(points, squares), squares + 1)
    return offsets


def segment_distances(a: Floats, b: Floats, columns: AnyIntegers, rows: AnyIntegers, n_squares: AnyIntegers) -> Floats:
    """Distances from segments, (k, 2) to (k, 2), each to the nearest of its own squares, (k,).

    The distance is zero if a segment meets a square, and infinite if it has no squares. The first `n_squares[0]` of all
    squares, (n,), belong to the first segment, and so on. Two convex shapes that do not meet are nearest at a vertex of
    one of them, and one of their sides separates them.
    """
    distances = np.full(len(a), inf)
    if len(columns) == 0:
        return distances
    ends = np.concatenate([a, b], axis=1)
    ax, ay, bx, by = (ends if len(a) == 1 else np.repeat(ends, n_squares, axis=0)).T
    dx, dy = bx - ax, by - ay
    # From the start of the segment to the corners of the squares, (4, n).
    wx, wy = columns + (_CORNERS_X - ax), rows + (_CORNERS_Y - ay)
    side = wx * dy - wy * dx
    meets = (side.min(axis=0) <= 0.0) & (side.max(axis=0) >= 0.0)
    meets &= (columns <= np.maximum(ax, bx)) & (columns >= np.minimum(ax, bx) - 1.0)
    meets &= (rows <= np.maximum(ay, by)) & (rows >= np.minimum(ay, by) - 1.0)
    squared = np.minimum(_squared_distances(ax, ay, columns, rows), _squared_distances(bx, by, columns, rows))
    # A segment that is a point has no direction; its distances are those of its ends, which are measured already.
    along = (wx * dx + wy * dy) / np.maximum(dx * dx + dy * dy, 1e-300)
    along = np.minimum(np.maximum(along, 0.0), 1.0)
    ex, ey = wx - along * dx, wy - along * dy
    squared = np.minimum(squared, (ex * ex + ey * ey).min(axis=0))
    squared[meets] = 0.0
    some = n_squares > 0
    begins = np.concatenate([[0], np.cumsum(n_squares[:-1])])[some]
    distances[some] = np.sqrt(np.minimum.reduceat(squared, begins))
    return distances


def _squared_distances(x: Floats, y: Floats, columns: AnyIntegers, rows: AnyIntegers) -> Floats:
    """Squared distances from points to squares, one each, (n,)."""
    ex = np.maximum(np.abs(columns + (0.5 - x)) - 0.5, 0.0)
    ey = np.maximum(np.abs(rows + (0.5 - y)) - 0.5, 0.0)
    squared: Floats = ex * ex + ey * ey
    return squared
