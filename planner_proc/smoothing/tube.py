"""The region in which a smoothed path has to stay: clear of obstacles and, if that is limited, near the route."""

from collections.abc import Sequence
from math import inf
from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.paths import distances_m
from planner_proc.clearance.field import ClearanceField

_MOST_HALVINGS: Final = 24
"""How often to halve a segment before it counts as too far from the path."""
_ROUNDING_M: Final = 1e-9
"""Excess over the greatest deviation that counts as rounding."""


class Tube:
    """All points that keep the clearance and are no farther from a path than `max_deviation_m`."""

    def __init__(
        self, field: ClearanceField, clearance_m: float, path_m: Floats, max_deviation_m: float | None = None
    ) -> None:
        """Take a path, (n, 2); None as the greatest deviation allows any."""
        self.field = field
        self.clearance_m = clearance_m
        self._path_m = path_m
        self._max_deviation_m = inf if max_deviation_m is None else max_deviation_m

    def segment_is_free(self, a_m: Sequence[float], b_m: Sequence[float]) -> bool:
        """Whether the whole segment between two points lies in the tube."""
        free = self.field.segment_is_free(a_m, b_m, self.clearance_m)
        return free and (self._max_deviation_m == inf or bool(self._near(np.array([a_m, b_m]))[0]))

    def free_segments(self, points_m: Floats) -> Flags:
        """Which segments of a polyline, (n, 2), lie in the tube, (n - 1,)."""
        free = self.field.free_segments(points_m, self.clearance_m)
        return free if self._max_deviation_m == inf else free & self._near(points_m)

    def _near(self, points_m: Floats) -> Flags:
        """Which segments stay near the path, (n - 1,).

        From the middle of a piece to its ends, the distance rises by at most half its length. Pieces that this does not
        decide are halved; the smallest ones count as too far.
        """
        low_m, high_m = points_m[:-1], points_m[1:]
        segment = np.arange(len(low_m))
        near = np.ones(len(low_m), dtype=np.bool_)
        for _ in range(_MOST_HALVINGS):
            middle_m = 0.5 * (low_m + high_m)
            half_m = 0.5 * np.hypot(*(high_m - low_m).T)
            apart_m = distances_m(middle_m, self._path_m)
            near[segment[apart_m > self._max_deviation_m]] = False
            unsure = near[segment] & (apart_m + half_m > self._max_deviation_m + _ROUNDING_M)
            if not unsure.any():
                return near
            low_m, middle_m, high_m, segment = low_m[unsure], middle_m[unsure], high_m[unsure], segment[unsure]
            low_m, high_m = np.concatenate([low_m, middle_m]), np.concatenate([middle_m, high_m])
            segment = np.concatenate([segment, segment])
        near[segment] = False
        return near
