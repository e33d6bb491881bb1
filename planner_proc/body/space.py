"""Where the trunk may be: a disc about its centre and the body keep their clearances."""

from math import ceil, hypot
from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.body.motion import filled
from planner_proc.clearance.field import ROUNDING_M, ClearanceField
from planner_proc.clearance.footprint_field import FootprintField, Squares

_DISC_M: Final = 0.12
"""Longest part of the body that one disc of the quick measure covers."""


class BodySpace:
    """Free poses, by a quick measure for many of them and by an exact one."""

    def __init__(
        self, grid: OccupancyGrid, field: ClearanceField, disc_m: float, body: Footprint, body_m: float
    ) -> None:
        """Take the `field` of the grid, the clearance of the trunk's centre, and the body with its clearance.

        The body is given in the frame of the trunk.
        """
        self._field = field
        self._disc_m = disc_m
        self._body_m = max(body_m, ROUNDING_M)  # a body that overlaps something has the distance 0
        self._footprints = FootprintField((body,), field, Squares(grid))
        self.reach_m = self._footprints.reach_m
        """Distance from the trunk's centre to the farthest point of the body."""
        self._discs = _covering_discs(body)

    def disc_is_free(self, points_m: Floats, extra_m: float) -> Flags:
        """Where the disc keeps `extra_m` more than its clearance, by the quick measure, for points (n, 2), (n,)."""
        apart = np.hypot(*self._field.offsets_m(points_m).T)
        free: Flags = (apart >= self._disc_m + extra_m) & self._field.on_grid(points_m)
        return free

    def body_seems_free(self, points_m: Floats, yaw_rad: float, extra_m: float) -> Flags:
        """The same for the body at one heading: discs cover it and reach a little beyond."""
        free = np.ones(len(points_m), dtype=np.bool_)
        c, s = np.cos(yaw_rad), np.sin(yaw_rad)
        for x_m, y_m, radius_m in self._discs:
            left = np.flatnonzero(free)
            at_m = points_m[left] + np.array([c * x_m - s * y_m, s * x_m + c * y_m])
            apart = np.hypot(*self._field.offsets_m(at_m).T)
            free[left] = (apart >= radius_m + self._body_m + extra_m) & self._field.on_grid(at_m)
        return free

    def body_is_free(self, poses: Floats) -> Flags:
        """In which poses, (n, 3), the body keeps its clearance, exactly, (n,)."""
        return self._footprints.free(poses, self._body_m + ROUNDING_M)

    def faults(self, poses: Floats) -> Flags:
        """Between which consecutive poses, (n, 3), disc or body do not keep their clearances, (n - 1,)."""
        faulty = ~self._field.free_segments(poses[:, :2], self._disc_m)
        between = [filled(poses[k : k + 2]) for k in range(len(poses) - 1)]
        owners = np.repeat(np.arange(len(between)), [len(part) for part in between])
        blocked = ~self.body_is_free(np.concatenate(between)) if between else np.zeros(0, dtype=np.bool_)
        faulty[owners[blocked]] = True
        return faulty

    def is_free(self, poses: Floats) -> bool:
        """Whether disc and body keep their clearances all along poses, (n, 3)."""
        return bool(self._field.free_segments(poses[:, :2], self._disc_m).all()) and bool(
            self.body_is_free(filled(poses)).all()
        )


def _covering_discs(body: Footprint) -> list[tuple[float, float, float]]:
    """Discs (x, y, radius) that cover the body, in the frame of the trunk: a row, with small ones at both ends."""
    n_along, n_across = ceil(body.length_m / _DISC_M), ceil(body.width_m / _DISC_M)
    part_m, across_m = body.length_m / n_along, body.width_m / n_across
    discs = []
    for k in range(n_along):
        is_end = k in (0, n_along - 1)
        width_m = across_m if is_end else body.width_m
        places_m = [((j + 0.5) * across_m - body.width_m / 2) for j in range(n_across)] if is_end else [0.0]
        for y_m in places_m:
            x_m = (k + 0.5) * part_m - body.length_m / 2
            (at,) = body.pose.apply([[x_m, y_m]]).tolist()
            discs.append((at[0], at[1], hypot(part_m, width_m) / 2))
    return discs
