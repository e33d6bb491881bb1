"""Progress: a bar on a terminal, and lines elsewhere, not too many of them."""

import io
from collections.abc import Iterator
from itertools import count

import pytest
from rich.console import Console

from legpush.long_work.progress import PERIOD_S, counted, pieces


def lines(period_s: float, total: int, done: int = 0) -> list[str]:
    """What is printed if a part is finished every `period_s`."""
    console = Console(file=io.StringIO(), width=200)
    times: Iterator[float] = (period_s * n for n in count())
    with counted(console, "evaluating", total, "episodes", done=done, clock=lambda: next(times)) as advance:
        for _ in range(total - done):
            advance()
    said: list[str] = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    return said


@pytest.mark.parametrize(("period_s", "n_lines"), [(PERIOD_S, 20), (PERIOD_S / 2, 10), (0.001, 1), (10 * PERIOD_S, 20)])
def test_lines_come_at_most_every_few_seconds_and_at_the_end(period_s: float, n_lines: int) -> None:
    said = lines(period_s, 20)
    assert len(said) == n_lines
    assert said[-1] == f"{20 * period_s:7.1f} s  evaluating  20 of 20 episodes"


def test_what_was_done_before_counts() -> None:
    assert [line.split("  ")[-1] for line in lines(PERIOD_S, 5, done=3)] == ["4 of 5 episodes", "5 of 5 episodes"]


def test_on_a_terminal_there_is_a_bar() -> None:
    console = Console(file=io.StringIO(), width=200, force_terminal=True)
    with counted(console, "pushing", 4, "series", done=1) as advance:
        advance()
    said = console.file.getvalue()  # type: ignore[attr-defined]
    assert "pushing" in said
    assert "2/4" in said


@pytest.mark.parametrize(("period_s", "n_lines"), [(PERIOD_S, 10), (PERIOD_S / 2, 5), (0.001, 0)])
def test_pieces_are_told_now_and_then(period_s: float, n_lines: int) -> None:
    console = Console(file=io.StringIO(), width=200)
    times: Iterator[float] = (period_s * n for n in count())
    show = pieces(console, "exporting", clock=lambda: next(times))
    for n_done in range(1, 11):
        show(n_done, 10)
    said = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert len(said) == n_lines
    assert all("  exporting  " in line for line in said)


def test_on_a_terminal_pieces_leave_no_line() -> None:
    console = Console(file=io.StringIO(), force_terminal=True)
    show = pieces(console, "exporting")
    show(1, 2)
    show(2, 2)
    assert console.file.getvalue() == "\r1 of 2 pieces\r\033[K"  # type: ignore[attr-defined]
