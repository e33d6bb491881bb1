"""Rounds the corners of a polyline by arcs: the simplest path with a minimum turning radius."""

from itertools import pairwise
from math import atan2, ceil, cos, pi, sin, tan
from typing import Final

import numpy as np

from legpush.arrays import Floats
from planner_proc.smoothing import polylines

_STRAIGHT_RAD: Final = 1e-6
"""A corner that turns by less than this gets no arc."""


def fillet(corners_m: Floats, radius_m: float, spacing_m: float) -> Floats | None:
    """The lines of a polyline, (n, 2), with an arc at each corner, as points at most `spacing_m` apart, (k, 2).

    None if two arcs need more of the line between them than its length.
    """
    turns = polylines.turns(corners_m).tolist()
    legs_m = np.hypot(*np.diff(corners_m, axis=0).T)
    if any(abs(turn) > pi - 1e-3 for turn in turns):
        return None
    # The points of an arc are equally spaced, so that the circle through any three of them is the arc's own.
    tangents_m = np.array([0.0, *(radius_m * tan(abs(turn) / 2) for turn in turns), 0.0])
    if (tangents_m[:-1] + tangents_m[1:] > legs_m + 1e-12).any():
        return None
    path = [corners_m[:1]]
    for k, turn in enumerate(turns, start=1):
        if abs(turn) > _STRAIGHT_RAD:
            path.append(_arc(corners_m[k - 1], corners_m[k], turn, radius_m, spacing_m))
    path.append(corners_m[-1:])
    return _densified(path, spacing_m)


def _arc(before_m: Floats, corner_m: Floats, turn_rad: float, radius_m: float, spacing_m: float) -> Floats:
    """Points of the arc that cuts off a corner, both ends included, (n, 2)."""
    heading = atan2(*(corner_m - before_m)[::-1].tolist())
    side = 1.0 if turn_rad > 0.0 else -1.0
    along = np.array([cos(heading), sin(heading)])
    begin = corner_m - radius_m * tan(abs(turn_rad) / 2) * along
    centre = begin + side * radius_m * np.array([-sin(heading), cos(heading)])
    n = max(2, ceil(radius_m * abs(turn_rad) / spacing_m))
    angles = heading - side * pi / 2 + np.linspace(0.0, turn_rad, n + 1)
    arc: Floats = centre + radius_m * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return arc


def _densified(parts: list[Floats], spacing_m: float) -> Floats:
    """Join the parts, with points on the lines between them, (n, 2). The points within a part stay as they are."""
    points = [parts[0]]
    for before, after in pairwise(parts):
        line = np.stack([before[-1], after[0]])
        length_m = polylines.length(line)
        if length_m > 1e-9:
            n = max(1, ceil(length_m / spacing_m))
            points.append(np.linspace(line[0], line[1], n + 1)[1:])
            points.append(after[1:])
        else:
            points.append(after[1:])
    return np.concatenate(points)
