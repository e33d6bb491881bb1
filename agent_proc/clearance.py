"""Exact distances to the occupied squares of a grid, as the protocol defines clearance; no planner has a part in it."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from legpush.geometry import Pose2
from legpush.messages import OccupancyGrid

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Nearest:
    """The place of a path that is nearest to something occupied."""

    distance_m: float
    at_m: tuple[float, float]


def clearance(grid: OccupancyGrid, points_m: Floats) -> Nearest:
    """Exact least distance of a polyline, (n, 2), to occupied squares, the outside included."""
    centres, half_m = _occupied(grid)
    low = np.array(grid.origin_m)
    high = low + np.array([grid.n_columns, grid.n_rows]) * grid.resolution_m
    borders = np.minimum(points_m - low, high - points_m).min(axis=1)
    worst = int(borders.argmin())
    best = Nearest(distance_m=max(0.0, float(borders[worst])), at_m=xy_of(points_m[worst]))
    if not len(centres) or best.distance_m == 0.0:
        return best
    columns, rows = np.floor((points_m - low) / grid.resolution_m).astype(int).clip(0).T
    inside = _cells(grid)[rows.clip(max=grid.n_rows - 1), columns.clip(max=grid.n_columns - 1)]
    if inside.any():
        return Nearest(distance_m=0.0, at_m=xy_of(points_m[int(inside.argmax())]))
    for a, b in pairwise(points_m if len(points_m) > 1 else np.repeat(points_m, 2, axis=0)):
        reach_m = best.distance_m + half_m
        box_low, box_high = np.minimum(a, b) - reach_m, np.maximum(a, b) + reach_m
        near = centres[((centres >= box_low) & (centres <= box_high)).all(axis=1)]
        if len(near):
            distance_m = float(segment_distances_m(a, b, near, half_m).min())
            if distance_m < best.distance_m:
                best = Nearest(distance_m=distance_m, at_m=xy_of((a + b) / 2))
    return best


def segment_distances_m(a: Floats, b: Floats, centres: Floats, half_m: float) -> Floats:
    """From a segment to squares, (n, 2) centres; 0 where they meet, (n,).

    Of two convex shapes apart, the nearest points include a corner of one of them.
    """
    corners = centres[:, None] + half_m * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    way = b - a
    length2 = float(way @ way)
    share = np.clip((corners - a) @ way / length2, 0.0, 1.0) if length2 > 0.0 else np.zeros(corners.shape[:2])
    apart = np.hypot(*np.moveaxis(corners - a - share[..., None] * way, -1, 0)).min(axis=1)
    for end in (a, b):
        beyond = np.maximum(np.abs(centres - end) - half_m, 0.0)
        apart = np.minimum(apart, np.hypot(*beyond.T))
    return np.where(_meet(a, b, centres, half_m), 0.0, apart)


def _meet(a: Floats, b: Floats, centres: Floats, half_m: float) -> NDArray[np.bool_]:
    """Whether a segment and squares overlap: no axis of the squares, and not the segment's normal, parts them."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    boxes = ((centres + half_m >= low) & (centres - half_m <= high)).all(axis=1)
    normal = np.array([a[1] - b[1], b[0] - a[0]])
    off = np.abs((centres - a) @ normal)
    meets: NDArray[np.bool_] = boxes & (off <= half_m * np.abs(normal).sum())
    return meets


def _occupied(grid: OccupancyGrid) -> tuple[Floats, float]:
    """Centres of the occupied squares that border on a free one, (n, 2), and half their side."""
    cells = _cells(grid)
    free = np.pad(~cells, 1, constant_values=True)
    exposed = cells & (free[:-2, 1:-1] | free[2:, 1:-1] | free[1:-1, :-2] | free[1:-1, 2:])
    rows, columns = np.nonzero(exposed)
    centres = (np.stack([columns, rows], axis=1) + 0.5) * grid.resolution_m + np.array(grid.origin_m)
    return centres, grid.resolution_m / 2


def _cells(grid: OccupancyGrid) -> NDArray[np.bool_]:
    """Which are occupied, (rows, columns)."""
    occupied: NDArray[np.bool_] = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns) != 0
    return occupied


def clearance_at(grid: OccupancyGrid, pose: Pose2) -> float:
    """Exact distance of a position to occupied squares, the outside included."""
    return clearance(grid, pose.xy()[np.newaxis]).distance_m


def xy_of(point: Floats) -> tuple[float, float]:
    x_m, y_m = point.tolist()
    return x_m, y_m
