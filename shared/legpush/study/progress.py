"""Shows how far a study is: a bar on a terminal, a line every ten seconds elsewhere."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Final

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.text import Text

from legpush.output.screen import can_draw_over
from legpush.study.runner import Tally

LINE_S: Final = 10.0
"""Time between lines without a terminal."""


@contextmanager
def shown(console: Console, more: Callable[[], str] = str) -> Iterator[Callable[[Tally], None]]:
    """Yield a function that shows a tally; `more` says what else is known of the cells that run."""
    began_s = last_s = monotonic()
    columns = (BarColumn(), TextColumn("{task.fields[text]}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=console, disable=not can_draw_over(console)) as bar:
        task = bar.add_task("cells", total=None, text="")

        def show(tally: Tally) -> None:
            nonlocal last_s
            now_s = monotonic()
            text = ", ".join(part for part in (line(tally, now_s - began_s), more()) if part)
            bar.update(task, total=tally.n_cells, completed=tally.n_done + tally.n_failed, text=text)
            if not can_draw_over(console) and now_s - last_s >= LINE_S:
                last_s = now_s
                console.print(Text(text), soft_wrap=True)

        yield show


def line(tally: Tally, passed_s: float) -> str:
    """Return one line on how far a study is, with its rate and the time left."""
    text = f"{tally.n_done} of {tally.n_cells} cells"
    if tally.n_failed:
        text += f", {tally.n_failed} failed"
    if tally.n_retried:
        text += f", {tally.n_retried} sent again"
    left = tally.n_cells - tally.n_done - tally.n_failed
    if tally.n_new and passed_s > 0.0:
        per_s = tally.n_new / passed_s
        rate = f"{per_s:.3g} cells/s" if per_s >= 1.0 else f"{1.0 / per_s:.3g} s per cell"
        text += f", {rate}, {duration(left / per_s)} left"
    return text


def duration(seconds: float) -> str:
    """Return a duration for people, such as `2 h 05 min`."""
    if seconds < 60.0:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"
