"""How waiting time is measured."""

import pytest

from legpush.patience import LONGEST_SLICE_S, Stopwatch
from tests.legpush.fakes import Clock


def test_a_stopwatch_counts_the_time_that_passes() -> None:
    clock = Clock()
    watch = Stopwatch(clock)
    for _ in range(10):
        clock.now_s += 0.1
        watch.tick()
    assert watch.elapsed_s == pytest.approx(1.0)
    watch.restart()
    assert watch.tick() == 0.0


def test_time_in_which_this_process_was_paused_does_not_count() -> None:
    clock = Clock()
    watch = Stopwatch(clock)
    clock.now_s += 3600.0
    assert watch.tick() == LONGEST_SLICE_S
