"""The occupancy map of a room: what the planner is told about it."""

from collections.abc import Collection, Sequence
from itertools import compress
from math import ceil
from typing import Final

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from legpush.messages.planning import OccupancyGrid
from legpush.scene.footprints import Footprint, obstacle_footprint
from legpush.scene.robot import FOOT_RECTANGLE_RADIUS_M
from legpush.scene.scenario import Planning, Room

TOUCH_M: Final = 1e-9
"""A cell that is overlapped by less than this is not touched: a wall along a cell border stays on its side of it."""


def clearance_m(planning: Planning) -> float:
    """What the trunk centre keeps from everything occupied: the foot rectangle's radius and the margin."""
    return FOOT_RECTANGLE_RADIUS_M + planning.margin_m


def room_by_now(room: Room, appeared: Collection[int]) -> Room:
    """The room without the obstacles that are yet to appear; `appeared` are the indices of those that have."""
    stands = [obstacle.appears_at_s == 0.0 or index in appeared for index, obstacle in enumerate(room.obstacles)]
    return room if all(stands) else replace(room, obstacles=tuple(compress(room.obstacles, stands)))


def occupancy_grid(room: Room, footprints: Sequence[Footprint] = ()) -> OccupancyGrid:
    """The room with its obstacles and whatever else stands in it, such as the box; every touched cell is occupied.

    Whether an obstacle has appeared is not asked: `room_by_now` leaves out what has not.

    Where the size of the room is no whole number of cells, the cells that reach beyond it are occupied.
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


def grid_shape(room: Room) -> tuple[int, int]:
    """Columns and rows of the room's occupancy map."""
    width_m, height_m = room.size_m
    return ceil((width_m - TOUCH_M) / room.resolution_m), ceil((height_m - TOUCH_M) / room.resolution_m)


def _occupy(occupied: NDArray[np.uint8], footprint: Footprint, resolution_m: float) -> None:
    """Mark the cells, (rows, columns), that overlap the footprint: no axis of either square or footprint parts them."""
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
