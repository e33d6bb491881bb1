import io

import pytest
from rich.console import Console

from legpush.study import progress
from legpush.study.progress import duration, line, shown
from legpush.study.runner import Tally


def test_a_line_has_rate_and_time_left() -> None:
    tally = Tally(n_cells=100, n_done=40, n_failed=2, n_retried=3, n_new=10)
    assert line(tally, 5.0) == "40 of 100 cells, 2 failed, 3 sent again, 2 cells/s, 29 s left"
    assert line(Tally(n_cells=10, n_done=5, n_new=5), 50.0) == "5 of 10 cells, 10 s per cell, 50 s left"
    assert line(Tally(n_cells=10, n_done=0), 50.0) == "0 of 10 cells"


def test_durations_are_for_people() -> None:
    assert [duration(s) for s in (5.0, 61.0, 3599.0, 7500.0)] == ["5 s", "1 min", "1 h 00 min", "2 h 05 min"]


def test_without_a_terminal_there_is_a_line_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([0.0, 1.0, 11.0, 12.0])
    monkeypatch.setattr(progress, "monotonic", lambda: next(times))
    text = io.StringIO()
    with shown(Console(file=text, width=200)) as show:
        for n_done in (1, 2, 3):
            show(Tally(n_cells=4, n_done=n_done, n_new=n_done))
    assert text.getvalue().splitlines() == ["2 of 4 cells, 5.5 s per cell, 11 s left"]
