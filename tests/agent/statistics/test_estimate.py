"""Estimates as tables and people see them."""

from math import isnan

from agent_proc.statistics.estimate import Estimate, kinds_in_words

SOME = Estimate(value=0.12345, low=0.1, high=0.15678, kind="Wilson 95 %", n=20)
WITHOUT = Estimate(value=0.12345, low=None, high=None, kind="no interval: n 1", n=1)


def test_a_text_has_value_interval_kind_and_n() -> None:
    assert f"{SOME:.2f}" == "0.12 [0.10, 0.16]"
    assert SOME.text(".0%") == "12% [10%, 16%] (Wilson 95 %, n 20)"
    assert WITHOUT.text(".2f") == "0.12 [-] (no interval: n 1, n 1)"


def test_columns_have_the_kind_and_n_of_the_interval() -> None:
    assert SOME.columns("share", 2) == {
        "share": 0.12,
        "share_low": 0.1,
        "share_high": 0.16,
        "share_interval": "Wilson 95 %",
        "share_n": 20,
    }
    assert WITHOUT.columns("share", 2)["share_low"] is None


def test_another_unit_changes_value_and_interval() -> None:
    cm = Estimate(value=0.5, low=0.25, high=1.0, kind="", n=2).scaled(100.0)

    assert (cm.value, cm.low, cm.high) == (50.0, 25.0, 100.0)
    assert WITHOUT.scaled(100.0).low is None


def test_what_is_not_possible_is_cut_from_an_interval_and_told() -> None:
    errors = Estimate(value=0.2, low=-0.1, high=0.5, kind="Student's t 95 %", n=5)
    shares = Estimate(value=0.9, low=0.7, high=1.1, kind="Student's t 95 %", n=5)

    assert errors.cut(0.0) == Estimate(
        value=0.2, low=0.0, high=0.5, kind="Student's t 95 %, cut to what is possible", n=5
    )
    assert (shares.cut(0.0, 1.0).low, shares.cut(0.0, 1.0).high) == (0.7, 1.0)
    assert SOME.cut(0.0, 1.0) == SOME
    assert WITHOUT.cut(0.0) == WITHOUT
    assert kinds_in_words([errors.kind, errors.cut(0.0).kind]) == "Student's t 95 %"


def test_a_plot_gets_no_bar_without_an_interval() -> None:
    assert SOME.ends == (0.1, 0.15678)
    assert all(map(isnan, WITHOUT.ends))


def test_a_picture_names_each_kind_that_it_draws_once() -> None:
    assert kinds_in_words(["a 95 %", "all values equal", "b 95 %", "no interval: n 1", "a 95 %"]) == "a 95 % or b 95 %"
    assert kinds_in_words(["no interval: n 1"]) == "no interval"
