"""Shows how far a program is: a bar on a terminal, and elsewhere a line now and then."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Final

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from legpush.output.screen import can_draw_over

PERIOD_S: Final = 5.0
"""Least time between two lines where no bar can be drawn."""


@contextmanager
def counted(
    console: Console, what: str, total: int, unit: str, *, done: int = 0, clock: Callable[[], float] = monotonic
) -> Iterator[Callable[[], None]]:
    """Yield a function to call whenever one more of `total` is done.

    `what` is done with each of them, such as `evaluating` with `unit` `episodes`; `done` were done before.
    """
    if can_draw_over(console):
        with _bar(console) as bar:
            task = bar.add_task(what, total=total, completed=done)
            yield lambda: bar.advance(task)
        return
    began_s = shown_s = clock()

    def advance() -> None:
        nonlocal done, shown_s
        done += 1
        now_s = clock()
        if now_s - shown_s >= PERIOD_S or done == total:
            shown_s = now_s
            console.print(Text(f"{now_s - began_s:7.1f} s  {what}  {done} of {total} {unit}"), soft_wrap=True)

    yield advance


def pieces(console: Console, what: str, clock: Callable[[], float] = monotonic) -> Callable[[int, int], None]:
    """Return a function that shows how many pieces of a file are done, and of how many; nothing is left of it there.

    Where lines cannot be overwritten, it prints one now and then.
    """
    began_s = shown_s = clock()

    def show(n_done: int, n_all: int) -> None:
        nonlocal shown_s
        if console.quiet:
            return
        if can_draw_over(console):
            console.file.write(f"\r{n_done} of {n_all} pieces" if n_done < n_all else "\r\033[K")
            console.file.flush()
        elif (now_s := clock()) - shown_s >= PERIOD_S:
            shown_s = now_s
            console.print(Text(f"{now_s - began_s:7.1f} s  {what}  {n_done} of {n_all} pieces"), soft_wrap=True)

    return show


def _bar(console: Console) -> Progress:
    """A bar with the number of finished parts and the remaining time."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, TimeRemainingColumn(), console=console)
