"""Means and shares with 95 % intervals."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Final

import numpy as np

Z_95: Final = 1.959964
N_BOOTSTRAP: Final = 2000


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A mean or share and its 95 % interval."""

    value: float
    low: float
    high: float


def wilson(n_successes: int, n: int) -> Estimate:
    """A share with Wilson's score interval."""
    share, z2 = n_successes / n, Z_95**2
    centre = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = Z_95 / (1 + z2 / n) * sqrt(share * (1 - share) / n + z2 / (4 * n**2))
    return Estimate(value=share, low=max(0.0, centre - half), high=min(1.0, centre + half))


def mean_interval(values: Sequence[float]) -> Estimate:
    """A mean with the percentile bootstrap interval, drawn with a fixed seed."""
    data = np.array(values)
    drawn = np.random.default_rng(0).integers(len(data), size=(N_BOOTSTRAP, len(data)))
    low, high = np.quantile(data[drawn].mean(axis=1), (0.025, 0.975)).tolist()
    return Estimate(value=float(data.mean()), low=low, high=high)
