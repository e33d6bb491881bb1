"""Exact distances to unit squares: square (column, row) reaches from there to (column + 1, row + 1)."""

from math import inf, sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.integer]

_CORNERS_X: Final = np.array([[0.0], [0.0], [1.0], [1.0]])
_CORNERS_Y: Final = np.array([[0.0], [1.0], [0.0], [1.0]])


def point_square_offsets(points: Floats, squares: Integers) -> Floats:
    """Shortest vectors from squares, (n, 2), to points, (n, 2); zero inside."""
    offsets: Floats = points - np.clip(points, squares, squares + 1)
    return offsets


def segment_distance(ax: float, ay: float, bx: float, by: float, columns: Integers, rows: Integers) -> float:
    """Distance from a segment to the nearest of some squares, (n,) each; zero where it meets one, infinite for none.

    Two convex shapes that do not meet are nearest at a vertex of one of them, and one of their sides separates them.
    """
    if len(columns) == 0:
        return inf
    dx, dy = bx - ax, by - ay
    # From the start of the segment to the corners of the squares, (4, n).
    wx, wy = columns + (_CORNERS_X - ax), rows + (_CORNERS_Y - ay)
    side = wx * dy - wy * dx
    meets = (side.min(axis=0) <= 0.0) & (side.max(axis=0) >= 0.0)
    meets &= (columns <= max(ax, bx)) & (columns >= min(ax, bx) - 1.0)
    meets &= (rows <= max(ay, by)) & (rows >= min(ay, by) - 1.0)
    if meets.any():
        return 0.0
    squared = min(_squared_distance(ax, ay, columns, rows), _squared_distance(bx, by, columns, rows))
    length_squared = dx * dx + dy * dy
    if length_squared > 0.0:
        along = np.clip((wx * dx + wy * dy) / length_squared, 0.0, 1.0)
        ex, ey = wx - along * dx, wy - along * dy
        squared = min(squared, float((ex * ex + ey * ey).min()))
    return sqrt(squared)


def _squared_distance(x: float, y: float, columns: Integers, rows: Integers) -> float:
    """From a point to the nearest of the squares."""
    ex = np.maximum(np.abs(columns + (0.5 - x)) - 0.5, 0.0)
    ey = np.maximum(np.abs(rows + (0.5 - y)) - 0.5, 0.0)
    return float((ex * ex + ey * ey).min())
