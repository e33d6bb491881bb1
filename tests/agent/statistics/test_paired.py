"""Comparisons by common seeds."""

import pytest

from agent_proc.statistics.intervals import mean
from agent_proc.statistics.paired import common, paired_difference, paired_ratio

# Gosset's sleep data (Biometrika 1908): extra hours of sleep of ten patients by either drug.
FIRST_H = dict(enumerate([0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0]))
SECOND_H = dict(enumerate([1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4]))


def test_only_seeds_that_both_have_are_compared() -> None:
    assert common({3: 1.0, 1: 2.0, 2: 5.0}, {1: 4.0, 3: 3.0, 7: 0.0}) == [(1.0, 3.0), (2.0, 4.0)]
    assert paired_difference({1: 1.0}, {2: 1.0}).kind == "no interval: no values"


def test_a_difference_by_seeds_is_known_better_than_both_means() -> None:
    found = paired_difference(SECOND_H, FIRST_H)

    # The published paired t test of these data: 1.58, 95 % 0.700 to 2.460.
    assert found.value == pytest.approx(1.58)
    assert found.ends == pytest.approx((0.700, 2.460), abs=5e-4)
    assert (found.kind, found.n) == ("Student's t 95 % of differences", 10)
    low, high = mean(list(FIRST_H.values())).ends
    assert high - low > found.ends[1] - found.ends[0]


def test_a_ratio_is_inverted_if_both_are_swapped() -> None:
    slow, fast = {0: 2.0, 1: 8.0, 2: 4.5}, {0: 1.0, 1: 2.0, 2: 1.5}

    there, back = paired_ratio(slow, fast), paired_ratio(fast, slow)

    assert there.value == pytest.approx((2.0 * 4.0 * 3.0) ** (1 / 3))
    assert back.value == pytest.approx(1 / there.value)
    assert back.ends == pytest.approx((1 / there.ends[1], 1 / there.ends[0]))
    assert there.kind == "Student's t 95 % of logarithms of ratios"


def test_a_ratio_needs_positive_values_and_two_seeds() -> None:
    with pytest.raises(ValueError, match=r"Expected positive values for a ratio, got 1.0 over 0.0"):
        paired_ratio({0: 1.0}, {0: 0.0})
    assert paired_ratio({0: 3.0}, {0: 2.0}).kind == "no interval: n 1"
