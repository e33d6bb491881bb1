"""Shows the progress of a training."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from agent_proc.learning import training_plan
from legpush.output.screen import can_draw_over

N_LINES: Final = 20
"""Number of lines of progress if there is no terminal to draw a bar on."""


@contextmanager
def shown(console: Console) -> Iterator[Any]:
    """A progress bar with return, success rate and remaining time, or plain lines without a terminal."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[numbers]}", markup=False),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    best: list[object] = [None]
    lines = 0
    with Progress(*columns, console=console, disable=not can_draw_over(console)) as bar:
        task = bar.add_task("learning", total=None, numbers="")

        def show(progress: training_plan.Progress) -> None:
            nonlocal lines
            numbers = f"{progress.step}/{progress.steps}"
            if progress.mean_return is not None and progress.success_rate is not None:
                numbers += f", return {progress.mean_return:.2f}, success {progress.success_rate:.0%}"
            bar.update(task, description=progress.doing, completed=progress.step, total=progress.steps, numbers=numbers)
            if not can_draw_over(console) and N_LINES * progress.step // progress.steps > lines:
                lines = N_LINES * progress.step // progress.steps
                console.print(Text(f"{progress.doing} {numbers}"), soft_wrap=True)
            if progress.best is not None and progress.best is not best[0]:
                best[0] = progress.best
                console.print(Text(f"step {progress.best.step}: {progress.best}"), soft_wrap=True)

        yield show
