"""Comparisons of two measurements by seeds that both have; what the seeds have in common cancels."""

from collections.abc import Hashable, Mapping
from dataclasses import replace
from math import exp, log
from typing import TypeVar

from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import mean

Key = TypeVar("Key", bound=Hashable)


def common(first: Mapping[Key, float], second: Mapping[Key, float]) -> list[tuple[float, float]]:
    """The pairs of values of the keys that both have, in the order of the first."""
    return [(value, second[key]) for key, value in first.items() if key in second]


def paired_difference(first: Mapping[Key, float], second: Mapping[Key, float]) -> Estimate:
    """The mean of first minus second over the keys that both have."""
    return _paired(mean([one - other for one, other in common(first, second)]), "differences")


def paired_ratio(first: Mapping[Key, float], second: Mapping[Key, float]) -> Estimate:
    """The geometric mean of first over second over the keys that both have.

    Swapping the two inverts it, which an arithmetic mean of ratios does not.

    Raises:
        ValueError: A value is not positive.
    """
    pairs = common(first, second)
    for pair in pairs:
        if min(pair) <= 0.0:
            raise ValueError(f"Expected positive values for a ratio, got {pair[0]} over {pair[1]}")
    logs = mean([log(one / other) for one, other in pairs])
    low, high = (None if end is None else exp(end) for end in (logs.low, logs.high))
    return _paired(replace(logs, value=exp(logs.value), low=low, high=high), "logarithms of ratios")


def _paired(estimate: Estimate, what: str) -> Estimate:
    """Say in its kind what the interval was computed from."""
    return estimate if estimate.low is None else replace(estimate, kind=f"{estimate.kind} of {what}")
