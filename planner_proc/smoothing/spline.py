"""Makes a smooth path along a polyline: a spline inside the tube or, at worst, the polyline itself.

The spline goes through the knots of an elastic band, or through the corners of the polyline. It is sampled densely, and
every segment between samples is measured. If one collides, the band is fitted again; then the spline is drawn back to
the polyline within a window around the collision, and at last everywhere. With a minimum turning radius, a band that
bends too tightly is replaced by a stiffer one, and the last resort is the polyline with its corners rounded by arcs.
"""

from collections.abc import Iterator
from itertools import pairwise
from math import ceil
from typing import Final, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from legpush.arrays import Flags, Floats
from legpush.scene.paths import arc_lengths_m
from legpush.scene.plan_settings import Smoothing
from planner_proc.smoothing import polylines
from planner_proc.smoothing.band import ElasticBand
from planner_proc.smoothing.fillets import fillet
from planner_proc.smoothing.tube import Tube

SPACING_M: Final = 0.05
"""Greatest distance between the points of a smooth path."""
_N_FITS: Final = 4
"""How often to fit the band."""
_N_DRAW_BACKS: Final = 8
"""How often to draw the spline back around its collisions."""
_WINDOW_M: Final = 0.6
"""Half the length of the window in which a colliding spline is drawn back; its middle half is the polyline."""
_STIFFER: Final = 1.5
"""Factor of the stiffness after a band that bends too tightly."""
_RADIUS_SHARE: Final = 0.99
"""Least radius of the circle through three waypoints, as a share of the turning radius."""
_SHARP_RAD: Final = np.radians(15.0)
"""Sharper bends than this are turned on the spot."""


class _Curve(NamedTuple):
    """A dense curve beside a polyline."""

    points_m: Floats
    """(n, 2)."""
    at_m: Floats
    """Arc length of the polyline at each point, (n,)."""
    is_corner: Flags
    """Which points are corners of the polyline that must stay in the path, (n,)."""


def smooth(polyline_m: Floats, tube: Tube, options: Smoothing, min_turning_radius_m: float = 0.0) -> list[Floats]:
    """Dense stretches of a path between the ends of a polyline, (n, 2) each, all of them in the tube.

    The polyline has to lie in the tube. Each stretch begins where the one before it ends; there the path turns on the
    spot. With a turning radius the path is one stretch; the list is empty if no such path was found in the tube.
    """
    corners_at_m = arc_lengths_m(polyline_m)
    length_m = float(corners_at_m[-1])
    n_most = options.max_waypoints
    spacing_m = max(SPACING_M, length_m / n_most)
    fine_at_m = np.union1d(np.linspace(0.0, length_m, 3 * ceil(length_m / spacing_m) + 1), corners_at_m)
    is_corner = np.isin(fine_at_m, corners_at_m)
    nowhere = np.zeros_like(is_corner)
    limits = _Limits(tube, min_turning_radius_m)
    fault_at_m: Floats = np.empty(0)
    spline_m = straight_m = polylines.at(polyline_m, corners_at_m, fine_at_m)
    for spline_m in _splines(polyline_m, fine_at_m, tube, options, limits):
        path = _resample(_Curve(spline_m, fine_at_m, nowhere), n_most)
        fault_at_m = limits.faults(path)
        if len(fault_at_m) == 0:
            return _stretches(path)
    if min_turning_radius_m > 0.0:
        arcs_m = fillet(polyline_m, min_turning_radius_m, spacing_m)
        return [arcs_m] if arcs_m is not None and limits.holds(arcs_m) else []
    share = np.ones(len(fine_at_m)) if options.method != "none" else np.zeros(len(fine_at_m))
    for _ in range(_N_DRAW_BACKS if options.method != "none" else 0):
        share *= 1.0 - _window(fine_at_m, fault_at_m)
        blend_m = straight_m + share[:, None] * (spline_m - straight_m)
        path = _resample(_Curve(blend_m, fine_at_m, is_corner & (share == 0.0)), n_most)
        fault_at_m = limits.faults(path)
        if len(fault_at_m) == 0:
            return _stretches(path)
    return _stretches(_resample(_Curve(straight_m, fine_at_m, is_corner), n_most))


def _splines(polyline_m: Floats, at_m: Floats, tube: Tube, options: Smoothing, limits: "_Limits") -> Iterator[Floats]:
    """Candidates as points, (n, 2), at arc lengths of the polyline, (n,), each fitted better than the last."""
    if options.method == "spline" and len(polyline_m) > 2:
        yield CubicSpline(arc_lengths_m(polyline_m), polyline_m, bc_type="natural")(at_m)
    elif options.method == "spline":
        yield polylines.at(polyline_m, arc_lengths_m(polyline_m), at_m)
    elif options.method == "band":

        def lay(stiffness: float) -> ElasticBand:
            return ElasticBand(
                polyline_m, tube.field, tube.clearance_m, options.comfort_m, stiffness, options.max_deviation_m
            )

        stiffness = 1.0
        band = lay(1.0)
        for _ in range(_N_FITS):
            band.settle()
            spline_m = CubicSpline(band.knots_at_m, band.knots_m, bc_type="natural")(at_m)
            spline_m[[0, -1]] = polyline_m[[0, -1]]
            yield spline_m
            if limits.bends_too_tightly:
                stiffness *= _STIFFER
                band = lay(stiffness)


class _Limits:
    """What a dense path has to keep: the tube, and a turning radius or no sharp bends."""

    def __init__(self, tube: Tube, min_turning_radius_m: float) -> None:
        self._tube = tube
        self._least_m = _RADIUS_SHARE * min_turning_radius_m
        self.bends_too_tightly = False
        """Whether the path that was judged last did so."""

    def faults(self, path: _Curve) -> Floats:
        """Arc lengths of the polyline at which the path leaves the tube or bends too tightly, ascending.

        Without a turning radius, sharp bends that are not at a corner count as too tight.
        """
        middles_m = 0.5 * (path.at_m[:-1] + path.at_m[1:])
        collides = ~self._tube.free_segments(path.points_m)
        bends = self._bends(path.points_m)
        if self._least_m == 0.0:
            bends = _is_sharp(path) & ~path.is_corner[1:-1]
        self.bends_too_tightly = self._least_m > 0.0 and bool(bends.any())
        return np.union1d(middles_m[collides], path.at_m[1:-1][bends])

    def holds(self, points_m: Floats) -> bool:
        """Whether a path, (n, 2), stays in the tube and keeps the turning radius."""
        return bool(self._tube.free_segments(points_m).all()) and not self._bends(points_m).any()

    def _bends(self, points_m: Floats) -> Flags:
        """At which inner points, (n - 2,), the turning radius is not kept."""
        tight: Flags = polylines.turning_radii(points_m) < self._least_m
        return tight


def _resample(curve: _Curve, n_most: int) -> _Curve:
    """The same curve with points at most `SPACING_M` apart, corners included; farther apart if there were too many.

    A plan adds a waypoint at either end, and a corner counts twice, once for each stretch that meets there.
    """
    travelled_m = arc_lengths_m(curve.points_m)
    kept = np.flatnonzero(curve.is_corner[1:-1]) + 1
    bounds_m = travelled_m[np.concatenate([[0], kept, [-1]])]
    spacing_m = max(SPACING_M, float(bounds_m[-1]) / max(1, n_most - 3 - 2 * len(bounds_m)))
    parts = [
        np.linspace(begin, end, max(1, ceil((end - begin) / spacing_m)), endpoint=False)
        for begin, end in pairwise(bounds_m)
    ]
    where_m = np.concatenate([*parts, bounds_m[-1:]])
    is_corner = np.zeros(len(where_m), dtype=np.bool_)
    is_corner[np.cumsum([len(part) for part in parts[:-1]], dtype=np.int64)] = True
    at_m = np.interp(where_m, travelled_m, curve.at_m)
    return _Curve(polylines.at(curve.points_m, travelled_m, where_m), at_m, is_corner)


def _window(at_m: Floats, centres_m: Floats) -> Floats:
    """Weights, (n,): 1 near any of the centres, which ascend, falling smoothly to 0 at `_WINDOW_M` from them."""
    after = np.searchsorted(centres_m, at_m).clip(0, len(centres_m) - 1)
    before = np.maximum(after - 1, 0)
    distances_m = np.minimum(np.abs(at_m - centres_m[after]), np.abs(at_m - centres_m[before]))
    window: Floats = np.cos(0.5 * np.pi * np.clip(2.0 * distances_m / _WINDOW_M - 1.0, 0.0, 1.0)) ** 2
    return window


def _stretches(path: _Curve) -> list[Floats]:
    """Cut the path where it bends sharply."""
    cuts = [0, *(np.flatnonzero(_is_sharp(path)) + 1).tolist(), len(path.points_m) - 1]
    return [path.points_m[begin : end + 1] for begin, end in pairwise(cuts)]


def _is_sharp(path: _Curve) -> Flags:
    """Which inner points, (n - 2,), are bends that are turned on the spot."""
    sharp: Flags = np.abs(polylines.turns(path.points_m)) > _SHARP_RAD
    return sharp
