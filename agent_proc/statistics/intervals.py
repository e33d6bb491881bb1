"""95 % intervals of shares, means, medians and ratios of means, computed by SciPy.

Nothing is left out and nothing is invented: without values the estimate is nan; one value, or a value that is not
finite, has no interval; equal values have an interval of length 0. The `kind` of the estimate says which case it is.
"""

import warnings
from collections.abc import Callable, Sequence
from math import isfinite, isnan
from typing import Any, Final, Literal

import numpy as np
from scipy import stats

from agent_proc.statistics.estimate import EQUAL, NO_INTERVAL, Estimate
from legpush.arrays import Floats

CONFIDENCE: Final = 0.95
WILSON: Final = "Wilson 95 %"
STUDENT_T: Final = "Student's t 95 %"
OVER_GROUPS: Final = "Student's t over groups 95 %"
ORDER_STATISTICS: Final = "order statistics 95 %"
BCA: Final = "BCa bootstrap 95 %"
PERCENTILE: Final = "percentile bootstrap 95 %, as BCa is degenerate"
NO_VALUES: Final = f"{NO_INTERVAL}: no values"
ONE_VALUE: Final = f"{NO_INTERVAL}: n 1"
NOT_FINITE: Final = f"{NO_INTERVAL}: a value is not finite"
TOO_FEW: Final = f"{NO_INTERVAL}: the median needs n 6 or more"
DEGENERATE: Final = f"{NO_INTERVAL}: the bootstrap is degenerate"
FEWEST_FOR_BOOTSTRAP: Final = 30
"""With fewer values, BCa intervals of means are too short: of exponential values their coverage is 80 % at n 5 and 88 %
at n 10, that of Student's t 88 % and 90 %; from n 30 on both are above 91 %."""
METHODS: Final[tuple[tuple[Literal["BCa", "percentile"], str], ...]] = (("BCa", BCA), ("percentile", PERCENTILE))
N_RESAMPLES: Final = 9999
BATCH: Final = 1000
"""Resamples that are in memory at once."""


def share(n_yes: int, n: int) -> Estimate:
    """A share with Wilson's score interval.

    Raises:
        ValueError: `n_yes` is not within 0 to n.
    """
    if n == 0:
        return _without_interval(np.nan, NO_VALUES, 0)
    found = stats.binomtest(n_yes, n).proportion_ci(CONFIDENCE, method="wilson")
    return Estimate(value=n_yes / n, low=float(found.low), high=float(found.high), kind=WILSON, n=n)


def mean(values: Sequence[float]) -> Estimate:
    """A mean with the BCa bootstrap interval, drawn with a fixed seed; with Student's t for fewer than 30 values."""
    data = np.asarray(values, dtype=np.float64)
    if (plain := _plain(data)) is not None:
        return plain
    if len(data) >= FEWEST_FOR_BOOTSTRAP:
        return _bootstrap((data,), np.mean)
    return _student(data, STUDENT_T)


def median(values: Sequence[float]) -> Estimate:
    """A median with the interval between two order statistics, whose coverage is 95 % or more for any distribution."""
    data = np.asarray(values, dtype=np.float64)
    if (plain := _plain(data)) is not None:
        return plain
    value = float(np.median(data))
    low, high = np.array(stats.quantile_test(data, p=0.5).confidence_interval(CONFIDENCE)).tolist()
    if isnan(low) or isnan(high):
        return _without_interval(value, TOO_FEW, len(data))
    return Estimate(value=value, low=low, high=high, kind=ORDER_STATISTICS, n=len(data))


def ratio_of_means(over: Sequence[float], under: Sequence[float]) -> Estimate:
    """The mean of one measure over that of another of the same trials, with the BCa bootstrap interval.

    Raises:
        ValueError: The measures differ in their number of trials.
    """
    pairs = np.array(list(zip(over, under, strict=True)), dtype=np.float64).reshape(-1, 2)
    n = len(pairs)
    if n == 0:
        return _without_interval(np.nan, NO_VALUES, n)
    with np.errstate(all="ignore"):
        value = float(_ratio(pairs[:, 0], pairs[:, 1]))
    if not isfinite(value):
        return _without_interval(np.nan, NOT_FINITE, n)
    if n == 1:
        return _without_interval(value, ONE_VALUE, n)
    return _equal(value, n) if (pairs == pairs[0]).all() else _bootstrap((pairs[:, 0], pairs[:, 1]), _ratio)


def mean_of_groups(groups: Sequence[Sequence[float]]) -> Estimate:
    """The mean over groups of the means within them, such as starts within training seeds; `n` counts the groups.

    The interval is Student's t of the group means. Their variance contains both that between groups and that within,
    so a group of many starts does not pass for many trainings. If all groups have the same starts, the interval is
    valid for these starts.
    """
    means = [float(np.mean(group)) if len(group) else np.nan for group in groups]
    data = np.array(means, dtype=np.float64)
    if (plain := _plain(data)) is not None:
        return plain
    return _student(data, OVER_GROUPS)


def mean_curve(curves: Floats) -> tuple[Floats, Floats, Floats]:
    """Mean, low and high of each column by Student's t, (k,) each, of curves, (n, k); nan as interval if n is 1."""
    middle: Floats = curves.mean(axis=0)
    reach = _reach(curves) if len(curves) > 1 else np.full_like(middle, np.nan)
    return middle, middle - reach, middle + reach


def _plain(data: Floats) -> Estimate | None:
    """The estimate of the middle of values that need no statistics; None for all others."""
    n = len(data)
    if n == 0:
        return _without_interval(np.nan, NO_VALUES, n)
    if not np.isfinite(data).all():
        return _without_interval(np.nan, NOT_FINITE, n)
    if n == 1:
        return _without_interval(float(data[0]), ONE_VALUE, n)
    return _equal(float(data[0]), n) if (data == data[0]).all() else None


def _equal(value: float, n: int) -> Estimate:
    return Estimate(value=value, low=value, high=value, kind=EQUAL, n=n)


def _without_interval(value: float, kind: str, n: int) -> Estimate:
    return Estimate(value=value, low=None, high=None, kind=kind, n=n)


def _student(data: Floats, kind: str) -> Estimate:
    value, reach = float(data.mean()), float(_reach(data))
    return Estimate(value=value, low=value - reach, high=value + reach, kind=kind, n=len(data))


def _reach(values: Floats) -> Floats:
    """Half the length of Student's interval along the first axis."""
    n = len(values)
    reach: Floats = stats.t.ppf((1 + CONFIDENCE) / 2, n - 1) * values.std(axis=0, ddof=1) / np.sqrt(n)
    return reach


def _ratio(over: Floats, under: Floats, axis: int = -1) -> Any:
    return np.mean(over, axis=axis) / np.mean(under, axis=axis)


def _bootstrap(samples: tuple[Floats, ...], statistic: Callable[..., Any]) -> Estimate:
    """BCa, or by percentiles where BCa is not defined."""
    value, n = float(statistic(*samples)), len(samples[0])
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        for method, kind in METHODS:
            found = stats.bootstrap(
                list(samples),
                statistic,
                n_resamples=N_RESAMPLES,
                batch=BATCH,
                vectorized=True,
                paired=len(samples) > 1,
                confidence_level=CONFIDENCE,
                method=method,
                rng=np.random.default_rng(0),
            ).confidence_interval
            low, high = float(found.low), float(found.high)
            if isfinite(low) and isfinite(high):
                return Estimate(value=value, low=low, high=high, kind=kind, n=n)
    return _without_interval(value, DEGENERATE, n)
