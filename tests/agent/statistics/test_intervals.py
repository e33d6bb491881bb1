"""Intervals: published examples, coverage in simulations, and samples that have no interval."""

from collections.abc import Callable
from math import inf, isnan, nan

import numpy as np
import pytest

from agent_proc.statistics import intervals
from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import mean, mean_curve, mean_of_groups, median, ratio_of_means, share
from legpush.arrays import Floats

Draw = Callable[[np.random.Generator, int], Floats]

# Gosset's sleep data ("The probable error of a mean", Biometrika 1908): extra hours of sleep by the second drug over
# the first, whose 95 % interval of the mean is 0.70 to 2.46.
SLEEP_H = [1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4]
# Efron, Tibshirani: "An introduction to the bootstrap" (1993), table 14.1: spatial test A of 26 children.
SPATIAL = [48, 36, 20, 29, 42, 42, 20, 42, 22, 41, 45, 14, 6, 0, 33, 28, 34, 4, 32, 24, 47, 41, 24, 26, 30, 41]


@pytest.mark.parametrize(
    ("n_yes", "n", "low", "high"),
    # Newcombe: "Two-sided confidence intervals for the single proportion", Statistics in Medicine 1998, table I.
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_a_share_has_wilsons_interval(n_yes: int, n: int, low: float, high: float) -> None:
    found = share(n_yes, n)

    assert (found.value, found.n, found.kind) == (n_yes / n, n, "Wilson 95 %")
    assert found.ends == pytest.approx((low, high), abs=5e-5)


def test_a_share_of_nothing_is_unknown_and_more_than_all_is_refused() -> None:
    nothing = share(0, 0)

    assert isnan(nothing.value)
    assert (nothing.low, nothing.high, nothing.n) == (None, None, 0)
    with pytest.raises(ValueError, match="must not be greater"):
        share(3, 2)


def test_the_mean_of_few_values_has_students_interval() -> None:
    found = mean(SLEEP_H)

    assert found.value == pytest.approx(1.58)
    assert found.ends == pytest.approx((0.700, 2.460), abs=5e-4)
    assert (found.kind, found.n) == ("Student's t 95 %", 10)


def test_the_mean_of_many_values_has_the_bca_interval_and_always_the_same_one() -> None:
    values = np.random.default_rng(3).exponential(size=60).tolist()

    found = mean(values)

    assert (found.n, found.kind) == (60, "BCa bootstrap 95 %")
    assert found == mean(values)
    low, high = found.ends
    # An interval of skewed values is longer on the side of the tail.
    assert low < found.value < high
    assert high - found.value > 1.1 * (found.value - low)


def test_bca_corrects_as_published(monkeypatch: pytest.MonkeyPatch) -> None:
    # Efron and Tibshirani, table 14.2: BCa interval of 90 % of the variance; by percentiles it is 100.8 to 233.9.
    monkeypatch.setattr(intervals, "CONFIDENCE", 0.9)

    found = intervals._bootstrap((np.array(SPATIAL, dtype=np.float64),), np.var)

    assert found.value == pytest.approx(171.5, abs=0.05)
    assert found.ends == pytest.approx((115.8, 259.6), rel=0.02)


def test_a_median_lies_between_order_statistics() -> None:
    # For n 10, the second smallest and the second largest: coverage 97.9 % (tables of the sign test).
    found = median([float(value) for value in range(10)])

    assert (found.value, found.low, found.high) == (4.5, 1.0, 8.0)
    assert (found.kind, found.n) == ("order statistics 95 %", 10)


def test_a_median_of_five_values_cannot_have_95_percent() -> None:
    found = median([1.0, 2.0, 3.0, 4.0, 5.0])

    assert (found.value, found.low, found.high) == (3.0, None, None)
    assert found.kind == "no interval: the median needs n 6 or more"


@pytest.mark.parametrize("estimate", [mean, median])
def test_samples_without_an_interval_say_why(estimate: Callable[[list[float]], Estimate]) -> None:
    nothing, one, bad, equal = estimate([]), estimate([2.0]), estimate([1.0, nan, 2.0]), estimate([0.1] * 3)

    assert isnan(nothing.value)
    assert (nothing.low, nothing.kind, nothing.n) == (None, "no interval: no values", 0)
    assert (one.value, one.low, one.high, one.kind) == (2.0, None, None, "no interval: n 1")
    assert isnan(bad.value)
    assert (bad.low, bad.kind, bad.n) == (None, "no interval: a value is not finite", 3)
    assert (equal.value, equal.low, equal.high, equal.kind) == (0.1, 0.1, 0.1, "all values equal")
    assert estimate([1.0, inf]).low is None


def test_a_ratio_of_means_is_bootstrapped_in_pairs() -> None:
    rng = np.random.default_rng(0)
    under = rng.uniform(1.0, 3.0, 40)
    over = 2.0 * under

    # The ratio of every resample is 2 only if both measures are drawn together.
    exact = ratio_of_means(over.tolist(), under.tolist())
    noisy = ratio_of_means((over + rng.normal(0.0, 0.2, 40)).tolist(), under.tolist())

    assert exact.value == pytest.approx(2.0)
    assert exact.ends == pytest.approx((2.0, 2.0))
    assert noisy.kind == "BCa bootstrap 95 %"
    low, high = noisy.ends
    assert 1.9 < low < noisy.value < high < 2.1
    assert high - low > 0.02


def test_ratios_without_an_interval_say_why() -> None:
    assert ratio_of_means([], []).kind == "no interval: no values"
    assert ratio_of_means([1.0, nan], [1.0, 1.0]).kind == "no interval: a value is not finite"
    assert ratio_of_means([1.0, 2.0], [1.0, -1.0]).kind == "no interval: a value is not finite"
    one, equal = ratio_of_means([1.0], [2.0]), ratio_of_means([1.0, 1.0], [2.0, 2.0])
    assert (one.value, one.low, one.kind) == (0.5, None, "no interval: n 1")
    assert (equal.low, equal.high, equal.kind) == (0.5, 0.5, "all values equal")
    with pytest.raises(ValueError, match="shorter"):
        ratio_of_means([1.0, 2.0], [1.0])


def test_a_bootstrap_that_cannot_be_corrected_says_so() -> None:
    # Without any one of these values the median is the same, so the jackknife says nothing about the skewness.
    by_percentiles = intervals._bootstrap((np.array([0.0, 1.0, 1.0, 1.0, 2.0]),), np.median)
    nothing = intervals._bootstrap((np.array([0.0, 1.0]),), lambda x, axis=-1: np.full(np.shape(x)[:-1], np.nan))

    assert by_percentiles.kind == "percentile bootstrap 95 %, as BCa is degenerate"
    assert by_percentiles.ends == (0.0, 2.0)
    assert (nothing.low, nothing.kind) == (None, "no interval: the bootstrap is degenerate")


def test_many_starts_do_not_pass_for_many_trainings() -> None:
    two_trainings = [[1.0] * 50, [3.0] * 50]

    found = mean_of_groups(two_trainings)

    # Student's t with one degree of freedom: 2 ± 12.706 x 1.
    assert (found.value, found.n, found.kind) == (2.0, 2, "Student's t over groups 95 %")
    assert found.ends == pytest.approx((2.0 - 12.706, 2.0 + 12.706), abs=1e-3)


def test_one_training_says_nothing_about_others_and_an_empty_one_is_not_left_out() -> None:
    assert mean_of_groups([[1.0, 2.0]]).kind == "no interval: n 1"
    assert mean_of_groups([[1.0], []]).kind == "no interval: a value is not finite"
    assert mean_of_groups([]).n == 0


def test_each_column_of_curves_has_students_interval() -> None:
    curves = np.column_stack([SLEEP_H, np.ones(10)])

    middle, low, high = mean_curve(curves)

    assert middle == pytest.approx([1.58, 1.0])
    assert low == pytest.approx([0.700, 1.0], abs=5e-4)
    assert high == pytest.approx([2.460, 1.0], abs=5e-4)
    assert np.isnan(mean_curve(curves[:1])[1]).all()


@pytest.mark.parametrize(
    ("draw", "estimate", "n", "truth", "least"),
    [
        (lambda rng, n: rng.normal(1.0, 2.0, n), mean, 8, 1.0, 0.93),
        (lambda rng, n: rng.normal(1.0, 2.0, n), mean, 40, 1.0, 0.90),
        (lambda rng, n: rng.exponential(1.0, n), mean, 40, 1.0, 0.89),
        (lambda rng, n: rng.exponential(1.0, n), median, 15, np.log(2.0), 0.94),
    ],
)
def test_about_95_percent_of_the_intervals_hold_the_truth(
    draw: Draw, estimate: Callable[[list[float]], Estimate], n: int, truth: float, least: float
) -> None:
    rng, n_samples = np.random.default_rng(0), 400
    ends = np.array([estimate(draw(rng, n).tolist()).ends for _ in range(n_samples)])

    held = ((ends[:, 0] <= truth) & (truth <= ends[:, 1])).mean()

    assert least < held < 0.99


def test_intervals_over_groups_hold_the_truth_where_those_over_all_values_do_not() -> None:
    rng, n_samples, held, naive = np.random.default_rng(0), 300, 0, 0
    for _ in range(n_samples):
        groups = rng.normal(0.0, 1.0, (5, 1)) + rng.normal(0.0, 1.0, (5, 5))
        low, high = mean_of_groups(groups.tolist()).ends
        held += low <= 0.0 <= high
        low, high = mean(groups.ravel().tolist()).ends
        naive += low <= 0.0 <= high

    assert 0.92 < held / n_samples < 0.98
    assert naive / n_samples < 0.85
