"""Means and shares with their intervals."""

from agent_proc.statistics import mean_interval, wilson


def test_a_share_has_wilsons_interval() -> None:
    some, all_of_them = wilson(8, 10), wilson(50, 50)

    assert (some.value, round(some.low, 3), round(some.high, 3)) == (0.8, 0.49, 0.943)
    assert (round(all_of_them.low, 3), round(all_of_them.high, 6)) == (0.929, 1.0)


def test_the_interval_of_a_mean_holds_it_and_is_always_the_same() -> None:
    values = [0.0, 1.0, 2.0, 3.0]

    estimate = mean_interval(values)

    assert estimate.value == 1.5
    assert 0.0 <= estimate.low < 1.5 < estimate.high <= 3.0
    assert mean_interval(values) == estimate
