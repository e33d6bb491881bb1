"""An elastic band between start and goal: tension shortens it, stiffness rounds it, and obstacles push it away."""

from math import ceil, inf
from typing import Final

import numpy as np
from scipy.linalg import cholesky_banded
from scipy.linalg.lapack import dpbtrs

from legpush.arrays import Floats
from legpush.scene.paths import arc_lengths_m
from planner_proc.clearance.field import ClearanceField
from planner_proc.smoothing import polylines

_KNOT_SPACING_M: Final = 0.15
_MIN_KNOTS: Final = 9
_MAX_KNOTS: Final = 601
_END_TAPER_M: Final = 0.5
"""Length from each end over which the comfort fades in, because start and goal cannot move away from obstacles."""
_SPARE_M: Final = 0.01
"""Clearance that the knots must have beyond the required one, for the sake of the curve between them."""
_TENSION_M2: Final = 0.1
"""Tension over stiffness of the comfort zone: a band of curvature 1/m sinks 0.1 m into it."""
_BENDING_M: Final = 0.7
"""Square root of bending stiffness over tension: a corner is rounded over about this length."""
_REACH: Final = 0.8
"""Share of the greatest deviation within which the knots stay, because the curve between them may go farther."""
_LEAN: Final = 0.3
"""Share of a missing clearance that is added to the lasting force at each step."""
_N_STEPS: Final = 40
"""How many steps to take when the band settles."""


class ElasticBand:
    """Knots along a path, equally spaced, with fixed ends.

    With y the deviation of the inner knots from the chord, tension and bending are the forces -K y, K = a T + b T T,
    where T is the tridiagonal matrix (-1, 2, -1). A step solves (1 + K) y' = y + push + lean, which is stable for large
    steps. The push is elastic. The lean grows at a knot for as long as the required clearance is missed there.
    """

    def __init__(
        self,
        path_m: Floats,
        field: ClearanceField,
        clearance_m: float,
        comfort_m: float,
        stiffness: float,
        max_deviation_m: float | None,
    ) -> None:
        """Lay a band along a path, (n, 2).

        `comfort_m` is the clearance that the band seeks beyond the required one. The length over which it rounds a
        corner is proportional to `stiffness`. The knots stay within a share of `max_deviation_m` of where they were
        laid.
        """
        vertices_at_m = arc_lengths_m(path_m)
        length_m = float(vertices_at_m[-1])
        n_knots = int(np.clip(ceil(length_m / _KNOT_SPACING_M) + 1, _MIN_KNOTS, _MAX_KNOTS))
        self.knots_at_m = np.linspace(0.0, length_m, n_knots)
        """Arc length of the path at which each knot was laid, (n,)."""
        self.knots_m = polylines.at(path_m, vertices_at_m, self.knots_at_m)
        """Present positions of the knots, (n, 2)."""
        self._laid_m = self.knots_m[1:-1]
        self._reach_m = inf if max_deviation_m is None else _REACH * max_deviation_m
        self._field = field
        self._required_m = clearance_m + _SPARE_M
        from_ends_m = np.minimum(self.knots_at_m, self.knots_at_m[::-1])[1:-1]
        self._wanted_m = clearance_m + comfort_m * np.minimum(1.0, from_ends_m / _END_TAPER_M)
        self._chord_m = np.linspace(self.knots_m[0], self.knots_m[-1], n_knots)[1:-1]
        self._lean_m = np.zeros_like(self._chord_m)
        self._factor = _factor(n_knots - 2, length_m / (n_knots - 1), stiffness * _BENDING_M)

    def settle(self) -> None:
        """Move the band toward its equilibrium."""
        inner_m = self.knots_m[1:-1]
        for _ in range(_N_STEPS):
            distances_m, away = self._solid(inner_m)
            self._lean_m += _LEAN * np.maximum(self._required_m - distances_m, 0.0)[:, None] * away
            push_m = self._push(inner_m, distances_m, away)
            deviation_m, _ = dpbtrs(self._factor, inner_m - self._chord_m + push_m + self._lean_m)
            inner_m = self._chord_m + deviation_m
            if self._reach_m < inf:
                inner_m = self._laid_m + self._within_reach(inner_m - self._laid_m)
        self.knots_m = np.concatenate([self.knots_m[:1], inner_m, self.knots_m[-1:]])

    def _within_reach(self, moves_m: Floats) -> Floats:
        """Displacements of the inner knots, (n, 2), cut to the reach."""
        lengths_m = np.hypot(*moves_m.T)
        within: Floats = moves_m * np.minimum(1.0, self._reach_m / np.maximum(lengths_m, 1e-12))[:, None]
        return within

    def _push(self, points_m: Floats, distances_m: Floats, away: Floats) -> Floats:
        """Steps of the knots to the clearance that is sought, (n, 2); in a narrow place, steps to its middle.

        With a distance d here and d' after a step s, the middle between two walls is (s + d' - d) / 2 from here.
        """
        steps_m = np.maximum(self._wanted_m - distances_m, 0.0)
        push_m = np.zeros_like(points_m)
        if len(near := np.flatnonzero(steps_m)):
            steps_m, away = steps_m[near], away[near]
            after_m, _ = self._solid(points_m[near] + steps_m[:, None] * away)
            wanted_m = 0.5 * (steps_m + after_m - distances_m[near])
            push_m[near] = np.minimum(np.maximum(wanted_m, 0.0), steps_m)[:, None] * away
        return push_m

    def _solid(self, points_m: Floats) -> tuple[Floats, Floats]:
        """Distances of points to the occupied squares, (n,), and unit vectors away from them, (n, 2)."""
        offsets_m = self._field.offsets_m(points_m)
        distances_m = np.hypot(offsets_m[:, 0], offsets_m[:, 1])
        return distances_m, offsets_m / np.maximum(distances_m, 1e-9)[:, None]


def _factor(n: int, spacing_m: float, bending_m: float) -> Floats:
    """Banded Cholesky factor, upper form, of 1 + a T + b T T for n inner knots."""
    a = _TENSION_M2 / spacing_m**2
    b = a * (bending_m / spacing_m) ** 2
    bands = np.empty((3, n))
    bands[0] = b
    bands[1] = -a - 4.0 * b
    bands[2] = 1.0 + 2.0 * a + 6.0 * b
    bands[2, [0, -1]] -= b
    factor: Floats = cholesky_banded(bands)
    return factor
