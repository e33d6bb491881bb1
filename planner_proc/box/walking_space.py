"""Whether the robot can walk around the box from one side to another, by connected cells of the grid."""

from collections.abc import Sequence
from math import ceil
from typing import Final

import numpy as np
from scipy import ndimage

from legpush.arrays import Floats, Integers
from legpush.geometry import Pose2
from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.clearance.field import ClearanceField

AROUND_M: Final = 2.5
"""How far around the box to look for a way first, before the whole grid."""
ROWS_AT_ONCE: Final = 256
"""How many rows of cells to measure at once, to save memory."""


class WalkingSpace:
    """The cells at whose centres the trunk keeps its clearance from the grid; each question adds the box."""

    def __init__(self, grid: OccupancyGrid, field: ClearanceField, clearance_m: float) -> None:
        """Take the `field` of the grid, and the clearance that the trunk's centre must keep."""
        self._grid = grid
        self._clearance_m = clearance_m
        columns = np.arange(grid.n_columns)
        self._free = np.empty((grid.n_rows, grid.n_columns), dtype=np.bool_)
        for first in range(0, grid.n_rows, ROWS_AT_ONCE):
            rows = np.arange(first, min(first + ROWS_AT_ONCE, grid.n_rows))
            offsets = field.offsets_m(self._centres_m(rows, columns).reshape(-1, 2))
            self._free[rows] = (np.hypot(*offsets.T) >= clearance_m).reshape(len(rows), len(columns))

    def joins(self, begins_m: Floats, end_m: Floats, box: Footprint) -> bool:
        """Whether a way around the box leads from one of the points `begins_m`, (n, 2), to `end_m`, (2,)."""
        row, column = self._cell(end_m)
        if not (0 <= row < self._grid.n_rows and 0 <= column < self._grid.n_columns and self._free[row, column]):
            return False
        n = ceil(AROUND_M / self._grid.resolution_m)
        row, column = self._cell(box.pose.xy())
        near = (
            slice(max(row - n, 0), max(row + n + 1, 1)),
            slice(max(column - n, 0), max(column + n + 1, 1)),
        )
        return self._joins(begins_m, end_m, box, near) or self._joins(begins_m, end_m, box, (slice(None), slice(None)))

    def _joins(self, begins_m: Floats, end_m: Floats, box: Footprint, part: tuple[slice, slice]) -> bool:
        """The same as `joins`, within a part of the grid."""
        free = self._free[part].copy()
        rows, columns = (np.arange(*s.indices(n)) for s, n in zip(part, self._free.shape, strict=True))
        if not (len(rows) and len(columns)):
            return False
        # The box counts as covering every cell that it touches.
        reach_m = self._clearance_m + self._grid.resolution_m
        free &= _distance_m(box, self._centres_m(rows, columns)) >= reach_m
        labels, _ = ndimage.label(free)

        def label_at(point_m: Floats) -> int:
            row, column = self._cell(point_m)
            row, column = row - int(rows[0]), column - int(columns[0])
            inside = 0 <= row < len(rows) and 0 <= column < len(columns)
            return int(labels[row, column]) if inside else 0

        end = label_at(end_m)
        return end > 0 and any(label_at(begin_m) == end for begin_m in begins_m)

    def _centres_m(self, rows: Integers, columns: Integers) -> Floats:
        """Centres of cells, (rows, columns, 2)."""
        x, y = np.meshgrid(columns, rows)
        centres: Floats = (np.stack([x, y], axis=-1) + 0.5) * self._grid.resolution_m + np.array(self._grid.origin_m)
        return centres

    def _cell(self, point_m: Floats) -> tuple[int, int]:
        """Row and column of the cell at a point, which may be off the grid."""
        column, row = np.floor((point_m - np.array(self._grid.origin_m)) / self._grid.resolution_m).astype(int).tolist()
        return row, column


def places_behind(stand_off: Pose2, distances_m: Sequence[float]) -> Floats:
    """Poses behind a stand-off, at distances straight back from it, (n, 3)."""
    points_m = stand_off.apply(np.array([[-distance_m, 0.0] for distance_m in distances_m]))
    return np.column_stack([points_m, np.full(len(points_m), stand_off.yaw_rad)])


def _distance_m(footprint: Footprint, points_m: Floats) -> Floats:
    """Distances from a footprint to points, (..., 2); 0 inside."""
    seen = footprint.pose.inverse().apply(points_m.reshape(-1, 2))
    beyond = np.maximum(np.abs(seen) - np.array([footprint.length_m, footprint.width_m]) / 2, 0.0)
    distances: Floats = np.hypot(*beyond.T).reshape(points_m.shape[:-1])
    return distances
