"""Exact distances from points and segments to the occupied squares of a grid.

Names that end in `_m` are in metres, in the frame of the map. All others count cells of the grid with one ring of
occupied cells around it: cell (row, column) is the square from (column, row) to (column + 1, row + 1).
"""

from collections.abc import Sequence
from math import ceil, hypot, inf
from typing import Final

import numpy as np
from scipy import ndimage

from legpush.arrays import Flags, Floats, Integers
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.clearance.nearest import NearestCells
from planner_proc.clearance.squares import point_square_offsets, segment_distances

ROUNDING_M: Final = 1e-8
"""Distances that differ by less count as equal: rounding of coordinates, not a safety margin."""
NEAR_M: Final = 1.0
"""Default of how far from the occupied cells the nearest one of them is known."""
_POINT_M: Final = 1e-12
"""A shorter segment counts as a point, because its direction is lost to rounding."""
_LEAST_REACH: Final = 8
"""Least distance, in cells, within which the nearest occupied cell is known."""
_MEASURED_AT_ONCE: Final = 16
"""How many segments of a path to measure together, lowest bound first."""
_CELLS_AT_ONCE: Final = 200_000
"""How many cells the windows measured together may cover, to save memory."""
_WORTHWHILE: Final = 8.0
"""A step of this many cells along a segment is long enough: how much longer it could be is not computed."""


class ClearanceField:
    """Clearance of points and segments: the Euclidean distance to the nearest occupied square.

    Everything outside the grid is occupied. A lower bound per cell decides nearly every question; where it does not,
    the squares around are measured exactly. Nothing is reported free whose distance is below the required clearance by
    more than `ROUNDING_M`.
    """

    def __init__(self, grid: OccupancyGrid, near_m: float = NEAR_M) -> None:
        """Take a grid whose `cells` are `n_rows * n_columns` zeros and ones.

        `offsets_m` is reliable up to `near_m` from the occupied cells.
        """
        self._resolution_m = grid.resolution_m
        self._origin_m = grid.origin_m
        self._per_m = 1.0 / grid.resolution_m
        self.size_m = (grid.n_columns * grid.resolution_m, grid.n_rows * grid.resolution_m)
        self._low_m, self._extent_m = np.array(self._origin_m), np.array(self.size_m)
        cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)
        self._occupied = np.pad(cells != 0, 1, constant_values=True)
        self._last_cell = np.array(self._occupied.shape[::-1], dtype=np.float64) - 1.0
        self._exposed = _exposed(self._occupied)
        reach = max(_LEAST_REACH, ceil(min(near_m * self._per_m, *self._last_cell.tolist())) + 2)
        self._nearest = NearestCells(self._occupied, reach)

    def contains(self, x_m: float, y_m: float) -> bool:
        """Whether the point lies on the grid."""
        return 0.0 <= x_m - self._origin_m[0] <= self.size_m[0] and 0.0 <= y_m - self._origin_m[1] <= self.size_m[1]

    def clearance_m(self, points_m: Floats) -> Floats:
        """Exact distance of points, (n, 2), to the nearest occupied square, (n,); 0 inside one and off the grid."""
        return self._segment_clearance_m(points_m, points_m)

    def bounds_m(self, points_m: Floats, enough_m: Floats | float = inf) -> Floats:
        """Lower bounds of the clearance of points, (n, 2), (n,): quick to compute.

        They are too low by about a cell, and by more where they exceed `enough_m`.
        """
        columns, rows = self._cells_of(self._to_cells(points_m)).T
        bounds = self._nearest.bounds(rows, columns, enough_m * self._per_m) * self._resolution_m
        return np.where(self.on_grid(points_m), bounds, 0.0)

    def segment_is_free(self, a_m: Sequence[float], b_m: Sequence[float], clearance_m: float) -> bool:
        """Whether every point of the segment between two points keeps the clearance.

        Steps from both ends as far as the lower bound there allows, looks for a collision in the part that is left, and
        measures that part exactly if it finds none.
        """
        (ax_m, ay_m), (bx_m, by_m) = a_m, b_m
        if not (self.contains(ax_m, ay_m) and self.contains(bx_m, by_m)):
            return False
        length_m = hypot(bx_m - ax_m, by_m - ay_m)
        per_m = self._per_m
        per_step = per_m / length_m if length_m > _POINT_M else 0.0
        u, v = (ax_m - self._origin_m[0]) * per_m + 1.0, (ay_m - self._origin_m[1]) * per_m + 1.0
        du, dv = (bx_m - ax_m) * per_step, (by_m - ay_m) * per_step
        bound, resolution_m = self._nearest.bound, self._resolution_m
        least_m = 0.5 * resolution_m
        enough = clearance_m * per_m + _WORTHWHILE

        def step_m(at_m: float) -> float:
            return bound(int(v + at_m * dv), int(u + at_m * du), enough) * resolution_m - clearance_m

        begin_m, end_m = 0.0, length_m
        while (ahead_m := step_m(begin_m)) > least_m:
            begin_m += ahead_m
            if begin_m >= end_m:
                return True
        while (back_m := step_m(end_m)) > least_m:
            end_m -= back_m
            if begin_m >= end_m:
                return True
        at_m = begin_m
        while at_m < end_m:
            spare_m = self._upper_bound(u + at_m * du, v + at_m * dv) * self._resolution_m - clearance_m
            if spare_m < -ROUNDING_M:
                return False
            at_m += max(spare_m, self._resolution_m)
        au, av, bu, bv = u + begin_m * du, v + begin_m * dv, u + end_m * du, v + end_m * dv
        if self._upper_bound(bu, bv) * self._resolution_m < clearance_m - ROUNDING_M:
            return False
        rest = self._measure(np.array([[au, av]]), np.array([[bu, bv]]), [clearance_m * per_m])
        return float(rest[0]) * self._resolution_m >= clearance_m - ROUNDING_M

    def free_segments(self, points_m: Floats, clearance_m: float) -> Flags:
        """Which segments of a polyline, (n, 2), keep the clearance at every point, (n - 1,)."""
        free = self._segment_bounds_m(points_m, clearance_m) >= clearance_m
        rest = np.flatnonzero(~free)
        distances_m = self._segment_clearance_m(points_m[rest], points_m[rest + 1])
        free[rest] = distances_m >= clearance_m - ROUNDING_M
        return free

    def path_clearance_m(self, points_m: Floats) -> float:
        """Exact least clearance of a polyline, (n, 2), over all its points, not only the vertices."""
        least_m = float(self.clearance_m(points_m[:1])[0])
        bounds_m = self._segment_bounds_m(points_m, least_m)
        order = np.argsort(bounds_m)
        for first in range(0, len(order), _MEASURED_AT_ONCE):
            some = order[first : first + _MEASURED_AT_ONCE]
            if bounds_m[some[0]] >= least_m:
                break
            least_m = min(least_m, float(self._segment_clearance_m(points_m[some], points_m[some + 1]).min()))
        return least_m

    def offsets_m(self, points_m: Floats) -> Floats:
        """Vectors to points, (n, 2), from an occupied square near each, (n, 2); approximate.

        The square is the one nearest to the centre of the point's cell, so another one may be slightly nearer: this
        suits a search, not a verdict. Farther than `near_m` from the occupied cells, it may be any square.
        """
        points = self._to_cells(points_m)
        columns, rows = self._cells_of(points).T
        squares = self._nearest.squares(rows, columns)
        return point_square_offsets(points, squares[::-1].T) * self._resolution_m

    def is_separated(self, a_m: tuple[float, float], b_m: tuple[float, float], clearance_m: float) -> bool:
        """Whether it is certain that no path at this clearance joins the two points."""
        may_be_free = np.empty(self._occupied.shape, dtype=np.bool_)
        for rows, distances in self._nearest.centre_distances():
            # No point of a cell is farther from a square than the distance between their centres.
            may_be_free[rows] = distances * self._resolution_m >= clearance_m - ROUNDING_M
        labels, _ = ndimage.label(may_be_free, structure=np.ones((3, 3)))
        (a_column, a_row), (b_column, b_row) = self._cells_of(self._to_cells(np.array([a_m, b_m])))
        return bool(labels[a_row, a_column] != labels[b_row, b_column])

    def _to_cells(self, points_m: Floats) -> Floats:
        """Points in cells, (n, 2)."""
        points: Floats = (points_m - self._low_m) / self._resolution_m + 1.0
        return points

    def _cells_of(self, points: Floats) -> Integers:
        """Column and row of the cell that each point stands in, (n, 2); of the nearest one off the grid."""
        cells: Integers = np.minimum(np.maximum(points, 0.0), self._last_cell).astype(np.int64)
        return cells

    def _upper_bound(self, u: float, v: float) -> float:
        """Distance of a point to an occupied square near it, which is at least its clearance."""
        row, column = self._nearest.square(int(v), int(u))
        du, dv = column - u, row - v
        return hypot(max(du, -1.0 - du, 0.0), max(dv, -1.0 - dv, 0.0))

    def _segment_bounds_m(self, points_m: Floats, enough_m: float) -> Floats:
        """Lower bounds of the clearance of each segment of a polyline, (n - 1,), tight only up to `enough_m`.

        Along a segment, the clearance changes by at most the distance travelled.
        """
        lengths_m = np.linalg.norm(np.diff(points_m, axis=0), axis=1)
        bounds_m = self.bounds_m(points_m, enough_m + 0.5 * float(lengths_m.max(initial=0.0)))
        bounds: Floats = np.minimum(bounds_m[:-1], bounds_m[1:]) - 0.5 * lengths_m
        return bounds

    def on_grid(self, points_m: Floats) -> Flags:
        """Which points, (n, 2), lie on the grid, (n,)."""
        beyond = points_m - self._low_m
        on_grid: Flags = ((beyond >= 0.0) & (beyond <= self._extent_m)).all(axis=-1)
        return on_grid

    def _segment_clearance_m(self, a_m: Floats, b_m: Floats) -> Floats:
        """Exact distances of segments, (n, 2) to (n, 2), to the nearest occupied square, (n,)."""
        clearance_m = np.zeros(len(a_m))
        inside = np.flatnonzero(self.on_grid(a_m) & self.on_grid(b_m))
        a, b = self._to_cells(a_m[inside]), self._to_cells(b_m[inside])
        reach = [self._upper_bound(u, v) for u, v in a.tolist()]
        clearance_m[inside] = self._measure(a, b, reach) * self._resolution_m
        return clearance_m

    def _measure(self, a: Floats, b: Floats, reach: Sequence[float]) -> Floats:
        """Distances from segments on the grid, (n, 2) to (n, 2), to the nearest occupied square, (n,).

        Where the distance exceeds `reach`, it may be infinite.
        """
        spread = np.array(reach)[:, None] + 1e-6
        corner = np.maximum((np.minimum(a, b) - spread).astype(np.int64), 0)
        beyond = (np.maximum(a, b) + spread).astype(np.int64) + 1
        distances = np.zeros(len(a))
        n_at_once = max(1, _CELLS_AT_ONCE // int((beyond - corner).prod(axis=1).max(initial=1)))
        for first in range(0, len(a), n_at_once):
            some = slice(first, first + n_at_once)
            windows = zip(corner[some].tolist(), beyond[some].tolist(), strict=True)
            found = [np.nonzero(self._exposed[bottom:top, left:right]) for (left, bottom), (right, top) in windows]
            rows, columns = (np.concatenate(each) for each in zip(*found, strict=True))
            n_squares = np.array([len(each) for each, _ in found])
            begins, ends = a[some] - corner[some], b[some] - corner[some]
            distances[some] = segment_distances(begins, ends, columns, rows, n_squares)
        at_columns, at_rows = a.astype(np.int64).T
        distances[self._occupied[at_rows, at_columns]] = 0.0
        return distances


def _exposed(occupied: Flags) -> Flags:
    """Occupied cells with a free cell at one of their sides; the one nearest to a free point is among them."""
    free = ~occupied
    exposed = np.zeros_like(occupied)
    exposed[1:] |= free[:-1]
    exposed[:-1] |= free[1:]
    exposed[:, 1:] |= free[:, :-1]
    exposed[:, :-1] |= free[:, 1:]
    exposed &= occupied
    return exposed
