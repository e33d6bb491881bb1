"""A smooth path along a polyline, verified: a spline inside the clearance tube, the polyline itself at worst.

The spline goes through the knots of an elastic band. It is sampled densely and every segment between samples is
measured; where one collides, the band is fitted again, then the spline is drawn back to the polyline within a window
around the collision, and in the end everywhere.
"""

from itertools import pairwise
from math import ceil
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from planner_proc import polylines
from planner_proc.band import ElasticBand
from planner_proc.occupancy import ClearanceField

Floats = NDArray[np.float64]

SPACING_M: Final = 0.05
"""Greatest distance between the points of a smooth path."""
_MAX_POINTS: Final = 20_000
"""Longer paths get a wider spacing."""
_N_FITS: Final = 4
_N_DRAW_BACKS: Final = 8
_WINDOW_M: Final = 0.6
"""Half the length of the window in which a colliding spline is drawn back; its middle half is the polyline."""
_SHARP_RAD: Final = np.radians(15.0)
"""A sharper bend than this is turned on the spot."""


class _Curve(NamedTuple):
    """A dense curve, the places of its points along the polyline, and which of them are corners to keep."""

    points_m: Floats
    at_m: Floats
    is_corner: NDArray[np.bool_]


def smooth(polyline_m: Floats, field: ClearanceField, clearance_m: float) -> list[Floats]:
    """Dense stretches of a path between the ends of a polyline that keeps the clearance, (n, 2) each.

    Each stretch begins where the one before it ends; there the path turns on the spot. All of them keep the clearance.
    """
    corners_at_m = polylines.arc_lengths(polyline_m)
    length_m = float(corners_at_m[-1])
    spacing_m = max(SPACING_M, length_m / _MAX_POINTS)
    fine_at_m = np.union1d(np.linspace(0.0, length_m, 3 * ceil(length_m / spacing_m) + 1), corners_at_m)
    straight_m = polylines.at(polyline_m, corners_at_m, fine_at_m)
    is_corner = np.isin(fine_at_m, corners_at_m)
    nowhere = np.zeros_like(is_corner)

    band = ElasticBand(polyline_m, field, clearance_m)
    for _ in range(_N_FITS):
        band.settle()
        spline_m = CubicSpline(band.knots_at_m, band.knots_m, bc_type="natural")(fine_at_m)
        spline_m[[0, -1]] = polyline_m[[0, -1]]
        path = _resample(_Curve(spline_m, fine_at_m, nowhere), spacing_m)
        faults_at_m = _faults(path, field, clearance_m)
        if len(faults_at_m) == 0:
            return _stretches(path)
    share = np.ones(len(fine_at_m))
    for _ in range(_N_DRAW_BACKS):
        share *= 1.0 - _window(fine_at_m, faults_at_m)
        blend_m = straight_m + share[:, None] * (spline_m - straight_m)
        path = _resample(_Curve(blend_m, fine_at_m, is_corner & (share == 0.0)), spacing_m)
        faults_at_m = _faults(path, field, clearance_m)
        if len(faults_at_m) == 0:
            return _stretches(path)
    return _stretches(_resample(_Curve(straight_m, fine_at_m, is_corner), spacing_m))


def _resample(curve: _Curve, spacing_m: float) -> _Curve:
    """The same curve with points at most so far apart, its corners among them."""
    travelled_m = polylines.arc_lengths(curve.points_m)
    kept = np.flatnonzero(curve.is_corner[1:-1]) + 1
    bounds_m = travelled_m[np.concatenate([[0], kept, [-1]])]
    parts = [
        np.linspace(begin, end, max(1, ceil((end - begin) / spacing_m)), endpoint=False)
        for begin, end in pairwise(bounds_m)
    ]
    where_m = np.concatenate([*parts, bounds_m[-1:]])
    is_corner = np.zeros(len(where_m), dtype=np.bool_)
    is_corner[np.cumsum([len(part) for part in parts[:-1]], dtype=np.int64)] = True
    at_m = np.interp(where_m, travelled_m, curve.at_m)
    return _Curve(polylines.at(curve.points_m, travelled_m, where_m), at_m, is_corner)


def _faults(path: _Curve, field: ClearanceField, clearance_m: float) -> Floats:
    """Where along the polyline the path does not keep the clearance, or bends sharply but at a corner; ascending."""
    middles_m = 0.5 * (path.at_m[:-1] + path.at_m[1:])
    collides = ~field.free_segments(path.points_m, clearance_m)
    bends = _is_sharp(path) & ~path.is_corner[1:-1]
    return np.union1d(middles_m[collides], path.at_m[1:-1][bends])


def _window(at_m: Floats, centres_m: Floats) -> Floats:
    """1 near any of the centres, which ascend, and smoothly down to 0 at `_WINDOW_M` from them."""
    after = np.searchsorted(centres_m, at_m).clip(0, len(centres_m) - 1)
    before = np.maximum(after - 1, 0)
    distances_m = np.minimum(np.abs(at_m - centres_m[after]), np.abs(at_m - centres_m[before]))
    window: Floats = np.cos(0.5 * np.pi * np.clip(2.0 * distances_m / _WINDOW_M - 1.0, 0.0, 1.0)) ** 2
    return window


def _stretches(path: _Curve) -> list[Floats]:
    """The path cut where it bends sharply."""
    cuts = [0, *(np.flatnonzero(_is_sharp(path)) + 1).tolist(), len(path.points_m) - 1]
    return [path.points_m[begin : end + 1] for begin, end in pairwise(cuts)]


def _is_sharp(path: _Curve) -> NDArray[np.bool_]:
    """Which inner points are bends to turn on the spot."""
    sharp: NDArray[np.bool_] = np.abs(polylines.turns(path.points_m)) > _SHARP_RAD
    return sharp
