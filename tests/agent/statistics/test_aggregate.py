import numpy as np
import pytest
from scipy import stats

from agent_proc.statistics.aggregate import (
    ONE_OF_EACH,
    OVER_BOTH,
    OVER_STARTS,
    OVER_TRAININGS,
    Results,
    grand_mean,
    interquartile_mean,
    mean_difference,
    probability_of_improvement,
    profile,
)
from agent_proc.statistics.estimate import EQUAL
from legpush.arrays import Floats


def results(values: Floats, cases: tuple[int, ...] | None = None) -> Results:
    return Results(values=values, cases=cases or (0,) * values.shape[1])


def drawn(n_trainings: int, n_starts: int, spread: float, seed: int = 0) -> Floats:
    rng = np.random.default_rng(seed)
    trainings = spread * rng.normal(size=(n_trainings, 1))
    found: Floats = trainings + rng.normal(size=(n_trainings, n_starts))
    return found


def test_the_interquartile_mean_leaves_a_quarter_out_at_each_end() -> None:
    values = np.array([[0.0, 1.0, 2.0, 100.0], [1.0, 2.0, 3.0, 50.0]])
    estimate = interquartile_mean(results(values))
    assert estimate.value == pytest.approx(np.mean([1.0, 2.0, 2.0, 3.0]))
    assert estimate.value == pytest.approx(stats.trim_mean(values.ravel(), 0.25))
    assert (estimate.kind, estimate.n) == (OVER_BOTH, 2)


def test_trainings_that_differ_make_the_interval_wide_however_many_starts_there_are() -> None:
    alike, apart = (grand_mean(results(drawn(5, 400, spread))) for spread in (0.0, 1.0))
    assert alike.low is not None
    assert alike.high is not None
    assert apart.low is not None
    assert apart.high is not None
    assert alike.high - alike.low < 0.3
    assert apart.high - apart.low > 0.6


def test_starts_are_drawn_within_their_case() -> None:
    values = np.array([[1.0] * 20 + [5.0] * 20])
    assert grand_mean(results(values, (0,) * 20 + (1,) * 20)).kind == EQUAL
    assert grand_mean(results(values)).kind == OVER_STARTS


def test_the_kind_says_what_was_drawn() -> None:
    assert grand_mean(results(drawn(3, 1, 1.0))).kind == OVER_TRAININGS
    alone = grand_mean(results(np.array([[2.0]])))
    assert (alone.value, alone.low, alone.kind) == (2.0, None, ONE_OF_EACH)
    with pytest.raises(ValueError, match=r"Expected \(trainings, 2 starts\)"):
        Results(values=np.zeros((2, 3)), cases=(0, 0))


def test_differences_are_those_of_equal_starts() -> None:
    start = 10.0 * np.random.default_rng(1).normal(size=(1, 50))
    first, second = start + 1.0 + 0.01 * drawn(4, 50, 1.0), start
    estimate = mean_difference(results(first), results(second))
    assert estimate.low is not None
    assert estimate.high is not None
    assert estimate.value == pytest.approx(1.0, abs=0.05)
    assert estimate.high - estimate.low < 0.1, "what the starts have in common cancels"
    with pytest.raises(ValueError, match="Expected contestants with equal starts"):
        mean_difference(results(first), results(first[:, :9]))


def test_the_probability_of_improvement_counts_pairs_of_trainings_on_equal_starts() -> None:
    first, second = np.array([[1.0, 1.0], [3.0, 0.0]]), np.array([[2.0, 0.0]])
    # Start 0: 1 < 2, 3 > 2; start 1: 1 > 0, and a tie.
    assert probability_of_improvement(results(first), results(second)).value == pytest.approx((1 + 0 + 0 + 0.5) / 4)
    assert probability_of_improvement(results(second), results(first)).value == pytest.approx(1 - 1.5 / 4)


def test_a_profile_is_the_share_of_values_up_to_each_threshold() -> None:
    found = profile(results(np.array([[0.5, 1.0, 2.0, 10.0]])), [0.1, 1.0, 10.0])
    assert [each.value for each in found] == [0.0, 0.5, 1.0]
    assert found[1].low is not None
    assert found[1].low < 0.5


def test_few_trainings_are_covered_as_often_as_the_text_says() -> None:
    hits = 0
    for seed in range(100):
        estimate = grand_mean(results(drawn(5, 1, 1.0, seed)[:, :1]))
        assert estimate.low is not None
        assert estimate.high is not None
        hits += estimate.low <= 0.0 <= estimate.high
    assert 70 <= hits <= 94
