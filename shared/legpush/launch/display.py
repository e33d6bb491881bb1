"""Shows the progress of a mission to the user: one progress line, and notices above it.

A display turns itself off when it cannot be written to any more: progress decides nothing about a mission.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager
from time import monotonic
from types import TracebackType
from typing import Final, Protocol, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.text import Text

from legpush.errors import one_line, printable
from legpush.output.screen import Screen, can_draw_over

PLAIN_PERIOD_S: Final = 5.0
"""Least time between two lines of one phase where lines cannot be overwritten."""


class Display(AbstractContextManager["Display"], Protocol):
    """Shows the user what the launcher is doing."""

    def progress(self, phase: str, fraction: float | None, detail: str, waiting_for: str) -> None:
        """Show what is being done now, in place of what was shown before; `fraction` is in [0, 1], or None."""

    def notice(self, text: str) -> None:
        """Show a line that stays."""


def make_display(console: Console) -> Display:
    """Return a live display on a terminal, and one that prints plain lines elsewhere."""
    return LiveDisplay(console) if can_draw_over(console) else PlainDisplay(console)


class LiveDisplay:
    """One line that is redrawn: phase, bar, detail, time."""

    def __init__(self, console: Console) -> None:
        self._bar = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=24),
            TextColumn("{task.fields[detail]}", markup=False),
            TextColumn("{task.fields[waiting]}", markup=False, style="yellow"),
            TimeElapsedColumn(),
            console=console,
        )
        self._screen = Screen()
        self._task = self._bar.add_task("starting", total=None, detail="", waiting="")
        self._shown: tuple[str, float | None, str, str] | None = None

    def __enter__(self) -> Self:
        self._screen.draw(self._bar.start)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._screen.draw(lambda: self._bar.remove_task(self._task))
        self._screen.draw(self._bar.stop)

    def progress(self, phase: str, fraction: float | None, detail: str, waiting_for: str) -> None:
        """Redraw the line if it has changed."""
        phase, detail, waiting_for = one_line(phase), one_line(detail), one_line(waiting_for)
        shown = (phase, fraction, detail, waiting_for)
        if shown == self._shown:
            return
        self._shown = shown
        (task,) = self._bar.tasks
        task.total = None if fraction is None else 1.0  # to `update`, None means "unchanged", not "unknown"
        self._screen.draw(
            lambda: self._bar.update(
                self._task,
                description=phase,
                completed=fraction or 0.0,
                detail=detail,
                waiting=_waiting(waiting_for),
                refresh=True,
            )
        )

    def notice(self, text: str) -> None:
        """Print a line above the redrawn one."""
        self._screen.draw(lambda: self._bar.console.print(Text(printable(text))))


class PlainDisplay:
    """Prints one line after the other: at each new phase, at each tenth of it, and otherwise every few seconds."""

    def __init__(self, console: Console, clock: Callable[[], float] = monotonic) -> None:
        self._console = console
        self._screen = Screen()
        self._clock = clock
        self._began = clock()
        self._shown: tuple[str, int | None, str] | None = None
        self._shown_at = -PLAIN_PERIOD_S
        self._line = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        return None

    def progress(self, phase: str, fraction: float | None, detail: str, waiting_for: str) -> None:
        """Print a line if enough has changed since the last one."""
        shown = (phase, None if fraction is None else int(10 * fraction), waiting_for)
        percent = "" if fraction is None else f"{fraction:4.0%}"
        line = "  ".join(filter(None, (phase, percent, detail, _waiting(waiting_for))))
        now = self._clock()
        if shown == self._shown and (line == self._line or now - self._shown_at < PLAIN_PERIOD_S):
            return
        self._shown, self._shown_at, self._line = shown, now, line
        self.notice(line)

    def notice(self, text: str) -> None:
        """Print a line."""
        line = Text(f"{self._clock() - self._began:7.1f} s  {printable(text)}")
        self._screen.draw(lambda: self._console.print(line, soft_wrap=True))


def _waiting(waiting_for: str) -> str:
    return f"waiting for {waiting_for}" if waiting_for else ""
