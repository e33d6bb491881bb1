"""Whether a box with the robot behind it fits: exact distances of moving rectangles to the occupied squares."""

from collections.abc import Sequence
from math import ceil
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from legpush.messages import OccupancyGrid
from legpush.room_shapes import Footprint
from planner_proc.occupancy import ROUNDING_M, ClearanceField

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

_DISC_PER_WIDTH: Final = 1.0
"""Discs that cover a rectangle have centres no farther apart than so many of its widths."""


class FootprintField:
    """Clearance of rectangles that are fixed to a moving frame.

    Discs that cover a rectangle, and one that it covers, decide nearly every question by the clearance of a point;
    where they do not, the distance to the squares around is computed exactly.
    """

    def __init__(self, grid: OccupancyGrid, footprints: Sequence[Footprint], field: ClearanceField) -> None:
        """`field` is that of the grid."""
        self._field = field
        self._rectangles = [_Rectangle(footprint) for footprint in footprints]
        self._squares = _Squares(grid)
        self.reach_m = max(rectangle.reach_m for rectangle in self._rectangles)
        """Of the point of all footprints that is farthest from the frame's origin."""
        self.narrowest_m = max(rectangle.inner_m for rectangle in self._rectangles)
        """Radius of the largest disc that one of them covers wherever it is: no path is narrower."""

    def free(self, poses: Floats, clearance_m: float) -> Flags:
        """Whether all footprints keep the clearance in poses (x, y, yaw), (n, 3), of the frame; (n,)."""
        free = np.ones(len(poses), dtype=np.bool_)
        for rectangle in self._rectangles:
            left = np.flatnonzero(free)
            if not left.size:
                break
            free[left] = self._keeps(rectangle, poses[left], clearance_m)
        return free

    def clearance_m(self, poses: Floats) -> float:
        """Exact least distance of any footprint in any of the poses, (n, 3), to anything occupied; 0 where they
        overlap.
        """
        least_m = np.inf
        for rectangle in self._rectangles:
            for pose in rectangle.centres(poses):
                least_m = min(least_m, self._squares.distance_m(pose, rectangle.half_m, least_m))
        return max(least_m, 0.0)

    def _keeps(self, rectangle: "_Rectangle", poses: Floats, clearance_m: float) -> Flags:
        discs = rectangle.discs(poses)
        bounds = self._field.bounds_m(discs.reshape(-1, 2)).reshape(discs.shape[:2]) - rectangle.disc_radius_m
        free: Flags = np.asarray((bounds >= clearance_m).all(axis=1))
        unsure = np.flatnonzero(~free)
        for index, pose in zip(unsure.tolist(), rectangle.centres(poses[unsure]), strict=True):
            limit_m = clearance_m - ROUNDING_M
            free[index] = self._squares.distance_m(pose, rectangle.half_m, clearance_m) >= limit_m
        return free


class _Rectangle:
    """A footprint in its moving frame."""

    def __init__(self, footprint: Footprint) -> None:
        pose = footprint.pose
        self._offset = np.array([pose.x_m, pose.y_m, pose.yaw_rad])
        self.half_m = np.array([footprint.length_m, footprint.width_m]) / 2
        self.reach_m = float(np.hypot(*footprint.corners().T).max())
        self.inner_m = float(self.half_m.min())
        along = int(self.half_m.argmax())
        n = ceil(self.half_m[along] / self.half_m[1 - along] / _DISC_PER_WIDTH)
        part_m = 2 * self.half_m[along] / n
        self._discs = np.zeros((n, 2))
        self._discs[:, along] = -self.half_m[along] + part_m * (np.arange(n) + 0.5)
        self.disc_radius_m = float(np.hypot(part_m / 2, self.half_m[1 - along]))

    def centres(self, poses: Floats) -> Floats:
        """Poses of the rectangle's centre, (n, 3)."""
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        x, y, yaw = self._offset
        centres: Floats = np.stack(
            [poses[:, 0] + c * x - s * y, poses[:, 1] + s * x + c * y, poses[:, 2] + yaw], axis=1
        )
        return centres

    def discs(self, poses: Floats) -> Floats:
        """Centres of the discs that cover it, (n, discs, 2)."""
        centres = self.centres(poses)
        c, s = np.cos(centres[:, 2])[:, None], np.sin(centres[:, 2])[:, None]
        x, y = self._discs.T
        discs: Floats = centres[:, None, :2] + np.stack([c * x - s * y, s * x + c * y], axis=-1)
        return discs


class _Squares:
    """The occupied cells, and a ring of them around the grid."""

    def __init__(self, grid: OccupancyGrid) -> None:
        cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)
        occupied = np.pad(cells != 0, 1, constant_values=True)
        rows, columns = np.nonzero(occupied)
        self._half_m = grid.resolution_m / 2
        self._centres_m = np.stack([columns - 0.5, rows - 0.5], axis=1) * grid.resolution_m + np.array(grid.origin_m)
        self._tree = cKDTree(self._centres_m)
        far = np.array([grid.n_columns, grid.n_rows]) * grid.resolution_m
        self._low_m, self._high_m = np.array(grid.origin_m), np.array(grid.origin_m) + far

    def distance_m(self, pose: Floats, half_m: Floats, within_m: float) -> float:
        """From a rectangle with its centre at a pose, (3,), to the nearest square; `within_m` where none is nearer.

        Of two convex shapes apart the nearest points include a corner of one of them; where no axis of either shape
        parts them, they overlap, and the distance is 0.
        """
        if not ((self._low_m <= pose[:2]) & (pose[:2] <= self._high_m)).all():
            return 0.0
        if np.isinf(within_m):
            within_m = float(self._tree.query(pose[:2])[0])
        radius_m = float(np.hypot(*half_m)) + within_m + 1.5 * self._half_m
        near = self._centres_m[self._tree.query_ball_point(pose[:2], radius_m)]
        if not len(near):
            return within_m
        c, s = np.cos(pose[2]), np.sin(pose[2])
        rotation = np.array([[c, -s], [s, c]])
        beside = near - pose[:2]
        corners = half_m * _SIGNS
        # Corners of the squares in the rectangle's frame, and of the rectangle in each square's.
        seen = (beside[:, None] + self._half_m * _SIGNS) @ rotation
        gaps = np.maximum(np.abs(seen) - half_m, 0.0)
        from_squares = np.hypot(gaps[..., 0], gaps[..., 1]).min()
        placed = corners @ rotation.T
        gaps = np.maximum(np.abs(placed - beside[:, None]) - self._half_m, 0.0)
        from_rectangle = np.hypot(gaps[..., 0], gaps[..., 1]).min()
        apart_own = (seen.min(axis=1) > half_m).any(axis=1) | (seen.max(axis=1) < -half_m).any(axis=1)
        extent = np.abs(placed).max(axis=0) + self._half_m
        apart_world = (np.abs(beside) > extent).any(axis=1)
        if not (apart_own | apart_world).all():
            return 0.0
        return float(min(from_squares, from_rectangle, within_m))


_SIGNS: Final = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
