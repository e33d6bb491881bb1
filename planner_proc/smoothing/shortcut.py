"""Shortens the jagged path of a random search by straight lines inside a tube, until it is nearly taut."""

from typing import Final

import numpy as np

from legpush.arrays import Floats
from planner_proc.smoothing import polylines
from planner_proc.smoothing.tube import Tube

_N_ROUNDS: Final = 3
"""Most rounds of shortening."""
_GAIN: Final = 0.02
"""Share of the length that a round must save for another round to follow."""
_LEG_M: Final = 0.25
"""Greatest distance between the points from which shortcuts are tried, unless there would be more than `_MAX_LEGS`."""
_MAX_LEGS: Final = 100
"""Longer paths are divided into about this many legs."""
_CUTS: Final = (0.5, 0.25, 0.125, 0.0625)
"""Shares of the two legs at a corner that a cut may take off, the largest first."""


def shortcut(points_m: Floats, tube: Tube) -> Floats:
    """A path between the same ends, (k, 2), that is no longer than the given one, (n, 2).

    It lies in the tube if the given one does.
    """
    best, best_m = points_m, polylines.length(points_m)
    for _ in range(_N_ROUNDS):
        path = _farthest_seen(polylines.subdivide(best, max(_LEG_M, best_m / _MAX_LEGS)), tube)
        path = _cut_corners(path, tube)
        path = _farthest_seen(path[::-1], tube)[::-1]
        length_m = polylines.length(path)
        if length_m >= best_m:
            break
        gain = 1.0 - length_m / best_m
        best, best_m = path, length_m
        if gain < _GAIN:
            break
    return best


def _farthest_seen(points_m: Floats, tube: Tube) -> Floats:
    """Go from each vertex straight to the last one to which the line is free."""
    points = points_m.tolist()
    last = len(points) - 1
    kept = [0]
    while (here := kept[-1]) < last:
        seen = (there for there in range(last, here + 1, -1) if tube.segment_is_free(points[here], points[there]))
        kept.append(next(seen, here + 1))
    return points_m[kept]


def _cut_corners(points_m: Floats, tube: Tube) -> Floats:
    """Cut off each corner by the longest free cut."""
    cut = [points_m[0]]
    for before, corner, after in zip(points_m[:-2], points_m[1:-1], points_m[2:], strict=True):
        for share in _CUTS:
            a, b = corner + share * (before - corner), corner + share * (after - corner)
            if tube.segment_is_free(a.tolist(), b.tolist()):
                cut += [a, b]
                break
        else:
            cut.append(corner)
    return np.array([*cut, points_m[-1]])
