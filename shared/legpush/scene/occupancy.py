"""The occupancy map of a room, as the planner gets it."""

from collections.abc import Collection, Sequence
from itertools import compress
from math import ceil
from typing import Annotated, Final

import numpy as np
from msgspec import Meta, Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from legpush.bounds import MAX_CELLS, Cells, Resolution
from legpush.geometry import Point2
from legpush.scene.footprints import Footprint, obstacle_footprint
from legpush.scene.scenario import Room, Scenario

TOUCH_M: Final = 1e-9
"""An overlap of less than this does not occupy a cell, so a wall along the border of a cell stays on its side."""


class OccupancyGrid(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A grid of square cells. Row 0 has the lowest y, column 0 the lowest x; everything outside is occupied."""

    n_columns: Cells
    n_rows: Cells
    resolution_m: Resolution
    origin_m: Point2
    """World position of the lower left corner of cell (0, 0)."""
    cells: Annotated[bytes, Meta(min_length=1, max_length=MAX_CELLS)]
    """One byte per cell, row by row: 0 is free, 1 is occupied."""

    def far_corner_m(self) -> Point2:
        """Return the world position of the corner with the highest x and y."""
        x_m, y_m = self.origin_m
        return x_m + self.n_columns * self.resolution_m, y_m + self.n_rows * self.resolution_m

    def extent(self) -> str:
        """Describe the area that the grid covers."""
        right_m, top_m = self.far_corner_m()
        return f"x {self.origin_m[0]:g} to {right_m:g} m and y {self.origin_m[1]:g} to {top_m:g} m"


def clearance_m(scenario: Scenario) -> float:
    """Return the clearance of the trunk centre from occupied cells: the radius of the foot circle plus the margin."""
    return scenario.robot.stance.foot_circle_m + scenario.planning.margin_m


def room_by_now(room: Room, appeared: Collection[int]) -> Room:
    """Return the room without the obstacles that are yet to appear; `appeared` has the indices of those that have."""
    stands = [obstacle.appears_at_s == 0.0 or index in appeared for index, obstacle in enumerate(room.obstacles)]
    return room if all(stands) else replace(room, obstacles=tuple(compress(room.obstacles, stands)))


def occupancy_grid(room: Room, footprints: Sequence[Footprint] = ()) -> OccupancyGrid:
    """Return the grid of a room; a cell is occupied if an obstacle or one of `footprints`, such as the box, touches it.

    All obstacles count, even those that have not appeared yet: use `room_by_now` to leave those out. If the size of the
    room is not a whole number of cells, the cells that reach beyond it are occupied.
    """
    n_columns, n_rows = grid_shape(room)
    occupied = np.zeros((n_rows, n_columns), dtype=np.uint8)
    width_m, height_m = room.size_m
    occupied[:, int((width_m + TOUCH_M) / room.resolution_m) :] = 1
    occupied[int((height_m + TOUCH_M) / room.resolution_m) :, :] = 1
    for footprint in (*map(obstacle_footprint, room.obstacles), *footprints):
        _occupy(occupied, footprint, room.resolution_m)
    return OccupancyGrid(
        n_columns=n_columns,
        n_rows=n_rows,
        resolution_m=room.resolution_m,
        origin_m=(0.0, 0.0),
        cells=occupied.tobytes(),
    )


def with_footprint(grid: OccupancyGrid, footprint: Footprint) -> OccupancyGrid:
    """Return the grid with the cells that a footprint touches occupied."""
    occupied = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns).copy()
    x_m, y_m = grid.origin_m
    at = replace(footprint, pose=replace(footprint.pose, x_m=footprint.pose.x_m - x_m, y_m=footprint.pose.y_m - y_m))
    _occupy(occupied, at, grid.resolution_m)
    return replace(grid, cells=occupied.tobytes())


def grid_shape(room: Room) -> tuple[int, int]:
    """Return the numbers of columns and rows of the room's occupancy map."""
    width_m, height_m = room.size_m
    return ceil((width_m - TOUCH_M) / room.resolution_m), ceil((height_m - TOUCH_M) / room.resolution_m)


def _occupy(occupied: NDArray[np.uint8], footprint: Footprint, resolution_m: float) -> None:
    """Mark the cells, (rows, columns), that overlap the footprint (separating axis test of square and footprint)."""
    corners = footprint.corners()
    low = np.floor((corners.min(axis=0) + TOUCH_M) / resolution_m).astype(int)
    high = np.ceil((corners.max(axis=0) - TOUCH_M) / resolution_m).astype(int)
    column_low, row_low = np.maximum(low, 0)
    column_high, row_high = np.maximum(np.minimum(high, occupied.shape[::-1]), 0)
    columns, rows = np.meshgrid(np.arange(column_low, column_high), np.arange(row_low, row_high))
    centres = (np.stack([columns.ravel(), rows.ravel()], axis=-1) + 0.5) * resolution_m
    c, s = np.cos(footprint.pose.yaw_rad), np.sin(footprint.pose.yaw_rad)
    reach = np.array([footprint.length_m, footprint.width_m]) / 2 + resolution_m / 2 * (abs(c) + abs(s)) - TOUCH_M
    touched = (np.abs(footprint.pose.inverse().apply(centres)) < reach).all(axis=1)
    occupied[row_low:row_high, column_low:column_high] |= touched.reshape(columns.shape).astype(np.uint8)
