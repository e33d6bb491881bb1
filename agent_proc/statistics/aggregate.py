"""Aggregates of trainings over seeds and starts, as Agarwal et al. 2021 (Deep Reinforcement Learning at the Edge of the
Statistical Precipice) propose: interquartile means, probabilities of improvement, and performance profiles.

Their bootstrap draws runs for each task by itself. Here one training is judged on many starts, so its results are no
independent draws. Ours draws whole trainings, and starts within each case (stratified); all contestants get the same
starts. With few trainings such intervals are too short: of 5 normal values the one of a mean covers about 83 %.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy import stats

from agent_proc.statistics.estimate import EQUAL, NO_INTERVAL, Estimate
from agent_proc.statistics.intervals import CONFIDENCE
from legpush.arrays import Floats, Integers

TRIMMED: Final = 0.25
"""Share of the values that an interquartile mean leaves out at each end."""
N_RESAMPLES: Final = 2000
BATCH: Final = 100
"""Resamples that are in memory at once."""
OVER_BOTH: Final = "percentile bootstrap over trainings and starts 95 %"
OVER_STARTS: Final = "percentile bootstrap over starts 95 %"
OVER_TRAININGS: Final = "percentile bootstrap over trainings 95 %"
ONE_OF_EACH: Final = f"{NO_INTERVAL}: one training and one start"

Statistic = Callable[..., Any]
"""Of one or two arrays (..., trainings, starts): a number for each of the leading indices."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Results:
    """One number for each training of a contestant and each start."""

    values: Floats
    """(trainings, starts); a policy that was not trained has one row."""
    cases: tuple[int, ...]
    """Index of the case of each start: starts are drawn within their case."""

    def __post_init__(self) -> None:
        if self.values.ndim != len(("trainings", "starts")) or self.values.shape[1] != len(self.cases):
            raise ValueError(f"Expected (trainings, {len(self.cases)} starts), got {self.values.shape}")


def interquartile_mean(results: Results) -> Estimate:
    """The mean of the middle half of all values."""
    return estimated(_iqm, results)


def grand_mean(results: Results) -> Estimate:
    """The mean of all values."""
    return estimated(_mean, results)


def mean_difference(first: Results, second: Results) -> Estimate:
    """The mean of first minus second, on equal starts."""
    return estimated(_difference, first, second)


def probability_of_improvement(first: Results, second: Results) -> Estimate:
    """The probability that a training of the first has a lower value than one of the second on the same start.

    Equal values count half.
    """
    return estimated(_improvement, first, second)


def profile(results: Results, thresholds: Sequence[float]) -> list[Estimate]:
    """The share of all values that are at most each threshold."""
    levels = np.array(thresholds, dtype=np.float64)

    def shares(values: Floats) -> Floats:
        ordered = np.sort(values.reshape(*values.shape[:-2], -1), axis=-1)
        found: Floats = (ordered[..., None] <= levels).mean(axis=-2)
        return found

    return _estimates(shares, (results,))


def estimated(statistic: Statistic, *contestants: Results) -> Estimate:
    """A statistic of one or two contestants on equal starts, with its interval; `n` is that of the trainings.

    Raises:
        ValueError: The starts of the contestants differ.
    """
    return _estimates(lambda *arrays: np.asarray(statistic(*arrays))[..., None], contestants)[0]


def _estimates(statistic: Statistic, contestants: tuple[Results, ...]) -> list[Estimate]:
    """An estimate for each element of the last axis of the statistic."""
    cases = np.array(contestants[0].cases)
    if any(each.cases != contestants[0].cases for each in contestants):
        raise ValueError("Expected contestants with equal starts")
    arrays = [each.values for each in contestants]
    values = np.atleast_1d(statistic(*arrays))
    n_trainings = [len(each.values) for each in contestants]
    n = min((n for n in n_trainings if n > 1), default=1)
    kind = _kind(max(n_trainings), cases)
    if kind is None:
        return [Estimate(value=float(each), low=None, high=None, kind=ONE_OF_EACH, n=n) for each in values]
    drawn = np.concatenate(list(_resampled(statistic, arrays, cases)))
    ends = (1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2
    low, high = np.quantile(drawn, ends, axis=0)
    return [
        Estimate(value=float(v), low=float(a), high=float(b), kind=EQUAL if a == b == v else kind, n=n)
        for v, a, b in zip(values, low, high, strict=True)
    ]


def _kind(n_trainings: int, cases: Integers) -> str | None:
    several_starts = np.unique(cases, return_counts=True)[1].max() > 1
    if n_trainings > 1:
        return OVER_BOTH if several_starts else OVER_TRAININGS
    return OVER_STARTS if several_starts else None


def _resampled(statistic: Statistic, arrays: Sequence[Floats], cases: Integers) -> Any:
    """Yield the statistic of resamples, (batch, elements) each, drawn with a fixed seed."""
    rng = np.random.default_rng(0)
    places = [np.flatnonzero(cases == case) for case in np.unique(cases)]
    for _ in range(N_RESAMPLES // BATCH):
        starts = np.concatenate([rng.choice(place, (BATCH, len(place))) for place in places], axis=1)
        drawn = []
        for array in arrays:
            trainings = rng.integers(len(array), size=(BATCH, len(array)))
            drawn.append(array[trainings[:, :, None], starts[:, None, :]])
        yield statistic(*drawn)


def _iqm(values: Floats) -> Any:
    return stats.trim_mean(values.reshape(*values.shape[:-2], -1), TRIMMED, axis=-1)


def _mean(values: Floats) -> Any:
    return values.mean(axis=(-2, -1))


def _difference(first: Floats, second: Floats) -> Any:
    return first.mean(axis=(-2, -1)) - second.mean(axis=(-2, -1))


def _improvement(first: Floats, second: Floats) -> Any:
    one, other = first[..., :, None, :], second[..., None, :, :]
    return ((one < other) + 0.5 * (one == other)).mean(axis=(-3, -2, -1))
