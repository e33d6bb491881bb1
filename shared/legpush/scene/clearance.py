"""Exact distances to the occupied squares of a grid, as the protocol defines clearance, independent of any planner."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.paths import distances_m


@dataclass(frozen=True, kw_only=True)
class Nearest:
    """The place on a path that is nearest to an occupied square."""

    distance_m: float
    at_m: tuple[float, float]


class Occupied:
    """The occupied squares of a grid, prepared for many queries."""

    def __init__(self, grid: OccupancyGrid) -> None:
        self.grid = grid
        self._cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns) != 0
        free = np.pad(~self._cells, 1, constant_values=True)
        exposed = self._cells & (free[:-2, 1:-1] | free[2:, 1:-1] | free[1:-1, :-2] | free[1:-1, 2:])
        rows, columns = np.nonzero(exposed)
        self._low = np.array(grid.origin_m)
        self._resolution_m = grid.resolution_m
        self._high = self._low + np.array([grid.n_columns, grid.n_rows]) * grid.resolution_m
        self._centres = (np.stack([columns, rows], axis=1) + 0.5) * grid.resolution_m + self._low
        """Centres of the occupied squares beside a free one, (n, 2)."""

    def nearest(self, points_m: Floats) -> Nearest:
        """Return the exact least distance of a polyline, (n, 2), to occupied squares; the outside is occupied."""
        half_m = self._resolution_m / 2
        borders = np.minimum(points_m - self._low, self._high - points_m).min(axis=1)
        worst = int(borders.argmin())
        best = Nearest(distance_m=max(0.0, float(borders[worst])), at_m=xy_of(points_m[worst]))
        if not len(self._centres) or best.distance_m == 0.0:
            return best
        columns, rows = np.floor((points_m - self._low) / self._resolution_m).astype(int).clip(0).T
        n_rows, n_columns = self._cells.shape
        inside = self._cells[rows.clip(max=n_rows - 1), columns.clip(max=n_columns - 1)]
        if inside.any():
            return Nearest(distance_m=0.0, at_m=xy_of(points_m[int(inside.argmax())]))
        for a, b in pairwise(points_m if len(points_m) > 1 else np.repeat(points_m, 2, axis=0)):
            reach_m = best.distance_m + half_m
            box_low, box_high = np.minimum(a, b) - reach_m, np.maximum(a, b) + reach_m
            near = self._centres[((self._centres >= box_low) & (self._centres <= box_high)).all(axis=1)]
            if len(near):
                distance_m = float(segment_distances_m(a, b, near, half_m).min())
                if distance_m < best.distance_m:
                    best = Nearest(distance_m=distance_m, at_m=xy_of((a + b) / 2))
        return best

    def distance_m(self, footprint: Footprint) -> float:
        """Return the exact distance of a rectangle to occupied squares, 0 if they overlap; the outside is occupied."""
        corners = footprint.corners()
        least_m = float(np.minimum(corners - self._low, self._high - corners).min())
        if least_m <= 0.0:
            return 0.0
        half_m = self._resolution_m / 2
        reach_m = least_m + half_m
        low, high = corners.min(axis=0) - reach_m, corners.max(axis=0) + reach_m
        near = self._centres[((self._centres >= low) & (self._centres <= high)).all(axis=1)]
        column, row = np.floor((footprint.pose.xy() - self._low) / self._resolution_m).astype(int)
        if self._cells[row, column]:
            return 0.0
        inside = np.abs(footprint.pose.inverse().apply(near)) < np.array([footprint.length_m, footprint.width_m]) / 2
        if inside.all(axis=1).any():
            return 0.0
        if not len(near):
            return least_m
        sides = pairwise(np.concatenate([corners, corners[:1]]))
        return min(least_m, *(float(segment_distances_m(a, b, near, half_m).min()) for a, b in sides))


def clearance(grid: OccupancyGrid, points_m: Floats) -> Nearest:
    """Return the exact least distance of a polyline, (n, 2), to occupied squares; the outside is occupied."""
    return Occupied(grid).nearest(points_m)


def segment_distances_m(a: Floats, b: Floats, centres: Floats, half_m: float) -> Floats:
    """Return the distances from a segment to squares with these centres, (n, 2); 0 if they meet, (n,).

    The nearest points of two convex shapes that do not meet include a corner of one of them.
    """
    corners = centres[:, None] + half_m * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    apart: Floats = distances_m(corners.reshape(-1, 2), np.array([a, b])).reshape(-1, 4).min(axis=1)
    for end in (a, b):
        beyond = np.maximum(np.abs(centres - end) - half_m, 0.0)
        apart = np.minimum(apart, np.hypot(*beyond.T))
    return np.where(_meet(a, b, centres, half_m), 0.0, apart)


def _meet(a: Floats, b: Floats, centres: Floats, half_m: float) -> Flags:
    """Return whether a segment and each square overlap, (n,): no axis of either separates them."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    boxes = ((centres + half_m >= low) & (centres - half_m <= high)).all(axis=1)
    normal = np.array([a[1] - b[1], b[0] - a[0]])
    off = np.abs((centres - a) @ normal)
    meets: Flags = boxes & (off <= half_m * np.abs(normal).sum())
    return meets


def xy_of(point: Floats) -> tuple[float, float]:
    x_m, y_m = point.tolist()
    return x_m, y_m
