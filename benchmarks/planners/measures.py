"""Measures of a path from any planner: length, smoothness, and clearance by the independent exact test."""

from dataclasses import dataclass
from math import pi
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.clearance import clearance
from planner_proc.conformance.truth import SAME_M

SPACING_M: Final = 0.05
"""Distance between the points at which headings are compared: a corner counts as if it were taken within this
distance."""


@dataclass(frozen=True, kw_only=True)
class Measures:
    """Measures of one path."""

    length_m: float
    clearance_m: float
    curvature_rms_per_m: float
    """Root mean square of the curvature along the path: sqrt(sum of (heading change)^2 / step / length)."""
    keeps_clearance: bool


def measured(query: TrunkPathQuery, points_m: Floats) -> Measures:
    """Measure a polyline, (n, 2)."""
    least_m = clearance(query.grid, points_m).distance_m
    steps_m = np.hypot(*np.diff(points_m, axis=0).T)
    return Measures(
        length_m=float(steps_m.sum()),
        clearance_m=least_m,
        curvature_rms_per_m=curvature_rms(points_m, folded=query.steering == "reeds_shepp"),
        keeps_clearance=bool(least_m >= query.clearance_m - SAME_M),
    )


def curvature_rms(points_m: Floats, *, folded: bool = False) -> float:
    """Return the RMS curvature in 1/m; `folded` counts a turn by more than a right angle as driving backward."""
    travelled_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points_m, axis=0).T))])
    n = max(2, round(travelled_m[-1] / SPACING_M))
    at_m = np.linspace(0.0, travelled_m[-1], n + 1)
    even = np.stack([np.interp(at_m, travelled_m, points_m[:, axis]) for axis in (0, 1)], axis=1)
    steps = np.diff(even, axis=0)
    turns = np.abs((np.diff(np.arctan2(steps[:, 1], steps[:, 0])) + pi) % (2.0 * pi) - pi)
    if folded:
        turns = np.minimum(turns, pi - turns)
    step_m = travelled_m[-1] / n
    return float(np.sqrt((turns**2).sum() / step_m / travelled_m[-1])) if travelled_m[-1] > 0.0 else 0.0


def points_of(plan: Plan) -> Floats:
    """Return the positions of a plan's waypoints, (n, 2)."""
    return np.array([waypoint.xy() for waypoint in plan.waypoints])
