"""Distances of moving rectangles to the occupied squares: whether the box fits, with the robot behind it."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from legpush.arrays import Flags, Floats
from legpush.geometry import Pose2
from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.clearance.field import ROUNDING_M, ClearanceField

_DISC_M: Final = 0.1
"""Largest side of the parts into which a rectangle is divided for the quick measure; a disc covers each part."""
_SIGNS: Final = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
"""Corners of a square with half side 1."""


def placed(poses: Floats, what: Pose2) -> Floats:
    """Compose poses: `what` is given in a frame, and the frame is at poses (x, y, yaw), (n, 3); returns (n, 3)."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    at: Floats = np.stack(
        [
            poses[:, 0] + c * what.x_m - s * what.y_m,
            poses[:, 1] + s * what.x_m + c * what.y_m,
            poses[:, 2] + what.yaw_rad,
        ],
        axis=1,
    )
    return at


class FootprintField:
    """Clearance of rectangles that are fixed to a moving frame, by a quick measure for searching and an exact one.

    The quick measure covers each rectangle with discs. They reach beyond it by 2 cm at its corners, and the distance of
    their centres to the nearest square is known to a fraction of a cell.
    """

    def __init__(self, footprints: Sequence[Footprint], field: ClearanceField, squares: "Squares") -> None:
        """Take the footprints in the moving frame, and `field` and `squares` of the same grid."""
        self._field = field
        self._rectangles = [_Rectangle(footprint) for footprint in footprints]
        self._squares = squares
        self.reach_m = max(rectangle.reach_m for rectangle in self._rectangles)
        """Distance from the frame's origin to the farthest point of all footprints."""
        self.narrowest_m = max(rectangle.inner_m for rectangle in self._rectangles)
        """Radius of the largest disc inside a footprint: no passage is narrower than twice this."""

    def seems_free(self, poses: Floats, clearance_m: float) -> bool:
        """Whether all footprints keep the clearance, by the quick measure, in all poses (x, y, yaw), (n, 3)."""
        for rectangle in self._rectangles:
            far = self._field.bounds_m(rectangle.centres(poses)[:, :2]) < rectangle.radius_m + clearance_m
            if not far.any():
                continue
            points = rectangle.discs(poses[far])
            distances = np.hypot(*self._field.offsets_m(points).T)
            if not ((distances >= rectangle.disc_radius_m + clearance_m) & self._field.on_grid(points)).all():
                return False
        return True

    def free(self, poses: Floats, clearance_m: float) -> Flags:
        """In which poses, (n, 3), all footprints keep the clearance, by the exact measure, (n,)."""
        free = np.ones(len(poses), dtype=np.bool_)
        for rectangle in self._rectangles:
            centres = rectangle.centres(poses)
            near = self._field.bounds_m(centres[:, :2]) < rectangle.radius_m + clearance_m
            for index in np.flatnonzero(free & near).tolist():
                distance_m = self._squares.distance_m(centres[index], rectangle.half_m, clearance_m)
                free[index] = distance_m >= clearance_m - ROUNDING_M
        return free

    def clearance_m(self, poses: Floats) -> float:
        """Exact least distance of all footprints in all poses, (n, 3), to anything occupied; 0 for an overlap."""
        least_m = np.inf
        for rectangle in self._rectangles:
            for pose in rectangle.centres(poses):
                least_m = min(least_m, self._squares.distance_m(pose, rectangle.half_m, least_m))
        return max(least_m, 0.0)


class _Rectangle:
    """A footprint in the moving frame, and the discs that cover it."""

    def __init__(self, footprint: Footprint) -> None:
        pose = footprint.pose
        self._pose = pose
        self.half_m = np.array([footprint.length_m, footprint.width_m]) / 2
        self.reach_m = float(np.hypot(*footprint.corners().T).max())
        self.radius_m = float(np.hypot(*self.half_m))
        self.inner_m = float(self.half_m.min())
        n = np.ceil(2 * self.half_m / _DISC_M)
        part_m = 2 * self.half_m / n
        steps = [
            -half + part * (np.arange(count) + 0.5) for half, part, count in zip(self.half_m, part_m, n, strict=True)
        ]
        self._discs = np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, 2)
        self.disc_radius_m = float(np.hypot(*part_m) / 2)

    def centres(self, poses: Floats) -> Floats:
        """Poses of the rectangle's centre for poses of the frame, (n, 3)."""
        return placed(poses, self._pose)

    def discs(self, poses: Floats) -> Floats:
        """Centres of the discs that cover it, in all poses of the frame, (n * discs, 2)."""
        centres = self.centres(poses)
        c, s = np.cos(centres[:, 2])[:, None], np.sin(centres[:, 2])[:, None]
        x, y = self._discs.T
        discs: Floats = centres[:, None, :2] + np.stack([c * x - s * y, s * x + c * y], axis=-1)
        return discs.reshape(-1, 2)


class Squares:
    """The occupied cells, with a ring of occupied cells around the grid."""

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
        """Distance from a rectangle to the nearest square; `within_m` if none is nearer.

        `pose` is that of its centre, (3,), and `half_m` half its length and width, (2,). If two convex shapes are
        apart, a corner of one of them is nearest to the other. If no axis of either shape separates them, they overlap,
        and the distance is 0.
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
        turned = corners @ rotation.T
        gaps = np.maximum(np.abs(turned - beside[:, None]) - self._half_m, 0.0)
        from_rectangle = np.hypot(gaps[..., 0], gaps[..., 1]).min()
        apart_own = (seen.min(axis=1) > half_m).any(axis=1) | (seen.max(axis=1) < -half_m).any(axis=1)
        extent = np.abs(turned).max(axis=0) + self._half_m
        apart_world = (np.abs(beside) > extent).any(axis=1)
        if not (apart_own | apart_world).all():
            return 0.0
        return float(min(from_squares, from_rectangle, within_m))
