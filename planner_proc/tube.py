"""What a path has to keep: its clearance and, where that is limited, its distance from the path of the search."""

from collections.abc import Sequence
from math import ceil, inf
from typing import Final

import numpy as np
from numpy.typing import NDArray

from planner_proc import polylines
from planner_proc.occupancy import ClearanceField

Floats = NDArray[np.float64]

_SAMPLE_SHARE: Final = 0.1
"""Of the greatest deviation: how far apart a segment is sampled to measure its own."""


class Tube:
    """All points with the clearance and no farther from a path, (n, 2), than `max_deviation_m`."""

    def __init__(
        self, field: ClearanceField, clearance_m: float, path_m: Floats, max_deviation_m: float | None = None
    ) -> None:
        self.field = field
        self.clearance_m = clearance_m
        self._path_m = path_m
        self._max_deviation_m = inf if max_deviation_m is None else max_deviation_m

    def segment_is_free(self, a_m: Sequence[float], b_m: Sequence[float]) -> bool:
        """Whether the whole segment between two points is in the tube."""
        near = self._max_deviation_m == inf or bool(self._near(np.array([a_m, b_m]))[0])
        return near and self.field.segment_is_free(a_m, b_m, self.clearance_m)

    def free_segments(self, points_m: Floats) -> NDArray[np.bool_]:
        """Which segments of a polyline, (n, 2), are in it, (n - 1,)."""
        free = self.field.free_segments(points_m, self.clearance_m)
        return free if self._max_deviation_m == inf else free & self._near(points_m)

    def _near(self, points_m: Floats) -> NDArray[np.bool_]:
        """Which segments stay near the path: samples do, with what the distance can rise by in between."""
        steps_m = np.hypot(*np.diff(points_m, axis=0).T)
        spacing_m = _SAMPLE_SHARE * self._max_deviation_m
        near = np.empty(len(steps_m), dtype=np.bool_)
        for k, step_m in enumerate(steps_m.tolist()):
            n = max(1, ceil(step_m / spacing_m))
            samples_m = np.linspace(points_m[k], points_m[k + 1], n + 1)
            distances_m = polylines.distances(self._path_m, samples_m)
            slack_m = np.zeros(n + 1)
            slack_m[1:-1] = 0.5 * step_m / n
            near[k] = bool((distances_m + slack_m <= self._max_deviation_m + 1e-9).all())
        return near
