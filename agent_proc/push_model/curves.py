"""The effect of pushes over their depth, as a curve of each leg that is fitted to the pushes up to now.

A Gaussian process (Rasmussen and Williams, *Gaussian Processes for Machine Learning*, ch. 2): before the first push,
both curves are those of the push model, mirror images of each other. How far a box may be from that grows with the
depth. A part is common to both legs, another part is opposite: of a centre of mass beside the middle, or of a slope
across the way. Depths that are near each other differ alike. The curves are kept as values at the depths of the model,
so a Kalman filter fits them, one push at a time.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from legpush.arrays import Floats

DEEP_M: Final = 0.1
"""Depth that the standard deviations below are those of."""
WALK_SHARE: Final = 0.03
"""Standard deviation by which a curve may change from one push to the next, in that before the first push."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """How far curves may be from those of the model, in one way."""

    sd: float
    """Standard deviation at `DEEP_M`."""
    power: float
    """That of the depth with which it grows."""
    reach_m: float
    """Depths that are this far apart are still correlated by 1/e."""

    def covariance(self, depth_m: Floats) -> Floats:
        """That of the values at depths, (n, n)."""
        grown = self.sd * (depth_m / DEEP_M) ** self.power
        apart_m = np.abs(depth_m[:, None] - depth_m)
        covariance: Floats = np.exp(-apart_m / self.reach_m) * grown[:, None] * grown
        return covariance


@dataclass(frozen=True, kw_only=True)
class Spread:
    """What is known of the curves of one quantity before the first push, and how well one push tells about them."""

    common: Part
    opposite: Part
    noise: float
    """Standard deviation of shallow pushes around their curve."""
    deep_noise: float
    """A further one of pushes of `DEEP_M`."""
    noise_power: float
    """The power of the depth with which that grows."""

    def variance(self, depth_m: Floats) -> Floats:
        """That of pushes around their curve."""
        grown: Floats = self.deep_noise * (depth_m / DEEP_M) ** self.noise_power
        return self.noise**2 + grown**2


class Curves:
    """One quantity by the depth of a push of FL, and of a push of FR whose mirror image is taken.

    There are several fits to the same pushes, which may differ in how deep each push was. Sums are elementwise and in
    order, without BLAS, so that they have the same bits everywhere.
    """

    def __init__(self, depth_m: Floats, expected: Floats, spread: Spread, n_fits: int = 1) -> None:
        """Begin every fit with what is expected of both legs at `depth_m`, which begin at 0."""
        self._depth_m = depth_m
        self._spread = spread
        common, opposite = spread.common.covariance(depth_m), spread.opposite.covariance(depth_m)
        covariance = np.block([[common + opposite, common - opposite], [common - opposite, common + opposite]])
        self._values = np.tile(np.concatenate([expected, expected]), (n_fits, 1))
        self._covariance = np.tile(covariance, (n_fits, 1, 1))
        self._walk = WALK_SHARE**2 * covariance
        self._fits = np.arange(n_fits)

    def values(self, fit: int = 0) -> Floats:
        """The curves of both legs, (2, n)."""
        values: Floats = self._values[fit].reshape(2, -1)
        return values

    def sd(self, fit: int = 0) -> Floats:
        """Standard deviations of pushes around them, with what is not known of the curves, (2, n)."""
        known = np.diagonal(self._covariance[fit]).reshape(2, -1)
        sd: Floats = np.sqrt(np.maximum(known, 0.0) + self._spread.variance(self._depth_m))
        return sd

    def learn(self, leg: int, depth_m: Floats, measured: Floats) -> Floats:
        """Fit the curves to one push, of the first leg or the second; return how likely it was, as a logarithm.

        `depth_m` and `measured` have the depth and the effect for each fit, (n_fits,), as the likelihoods.
        """
        seen = self._seen(leg, depth_m)
        covariance = self._covariance + self._walk
        spread = (covariance * seen[:, None, :]).sum(axis=2)
        variance = (seen * spread).sum(axis=1) + self._spread.variance(depth_m)
        gain = spread / variance[:, None]
        beyond = measured - (seen * self._values).sum(axis=1)
        self._values = self._values + gain * beyond[:, None]
        self._covariance = covariance - gain[:, :, None] * spread[:, None, :]
        likelihood: Floats = -0.5 * (beyond**2 / variance + np.log(variance))
        return likelihood

    def _seen(self, leg: int, depth_m: Floats) -> Floats:
        """The share that each value has in the effect of a push, (n_fits, 2 n)."""
        n = len(self._depth_m)
        seen = np.zeros((len(self._fits), 2 * n))
        after = np.minimum(np.searchsorted(self._depth_m, depth_m, side="right"), n - 1)
        low_m, high_m = self._depth_m[after - 1], self._depth_m[after]
        share = np.minimum((depth_m - low_m) / (high_m - low_m), 1.0)
        seen[self._fits, leg * n + after - 1], seen[self._fits, leg * n + after] = 1.0 - share, share
        return seen
