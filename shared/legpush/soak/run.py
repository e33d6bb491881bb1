"""`legpush bench soak`: disturbs missions and trainings, and says what came of it."""

import threading
from collections.abc import Iterator
from typing import Final

from rich.console import Console
from rich.text import Text

from legpush.errors import INTERRUPTED, ConfigError, StopRequestedError
from legpush.options.bench import SoakOptions
from legpush.output.reply import document
from legpush.runs.folder import own_folder
from legpush.service import stop_on_signals
from legpush.soak.cell_run import run_cell, undisturbed
from legpush.soak.results import SoakResults, read_results, table_lines, write_results
from legpush.soak.steps import run_steps
from legpush.soak.table import Cell, choose_cells
from legpush.soak.training import TrainingSoak

N_LINES: Final = 20
"""Number of lines of progress of the steps."""


def run_soak(options: SoakOptions, console: Console) -> int:
    """Do what is left of a soak; returns the exit code.

    Raises:
        ConfigError: There is no such cell, or the folder cannot be made.
        PeerError: Something ended that was not disturbed.
    """
    cells = choose_cells(options.cells) if options.table else ()
    stop = stop_on_signals()
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(
            f"Expected a folder that can be made for --out, got {options.out} ({error.strerror})"
        ) from error
    with own_folder(options.out):
        results = read_results(options.out)
        try:
            _run_table(options, cells, results, stop, console)
            _run_steps(options, results, stop, console)
            _run_training(options, results, stop, console)
        except StopRequestedError:
            console.print(Text("interrupted; the same command goes on"), soft_wrap=True)
            return INTERRUPTED
        finally:
            write_results(options.out, results)
    console.print(Text("\n".join(table_lines(results))), soft_wrap=True)
    document(results)
    return 0 if results.is_as_expected else 1


def _run_table(
    options: SoakOptions, cells: tuple[Cell, ...], results: SoakResults, stop: threading.Event, console: Console
) -> None:
    if options.retry:
        results.cells = [cell for cell in results.cells if cell.is_as_expected]
    done = {(cell.name, cell.seed) for cell in results.cells}
    left = [(cell, seed) for seed in _seeds(options) for cell in cells if (cell.name, seed) not in done]
    for number, (cell, seed) in enumerate(left, 1):
        expected = undisturbed(options.out / f"seed{seed}", seed)
        if stop.is_set():
            raise StopRequestedError("Asked to stop between two cells")
        result = run_cell(cell, options.out / f"seed{seed}" / cell.name, expected, seed)
        results.cells.append(result)
        write_results(options.out, results)
        words = "as expected" if result.is_as_expected else f"NOT as expected: {'; '.join(result.wrong)}"
        console.print(Text(f"{number:>4}/{len(left)}  {cell.name:<32} {result.took_s:6.1f} s  {words}"), soft_wrap=True)


def _run_steps(options: SoakOptions, results: SoakResults, stop: threading.Event, console: Console) -> None:
    """Do the steps that are left, in one stretch."""
    left = (options.steps or 0) - sum(each.n_steps for each in results.steps)
    if left <= 0:
        return

    shown = 0

    def progress(n_done: int) -> None:
        nonlocal shown
        if N_LINES * n_done // left > shown:
            shown = N_LINES * n_done // left
            console.print(Text(f"{n_done}/{left} steps"), soft_wrap=True)

    results.steps.append(run_steps(left, options.out / "steps", stop, progress))
    if stop.is_set():
        raise StopRequestedError("Asked to stop between two steps")


def _run_training(options: SoakOptions, results: SoakResults, stop: threading.Event, console: Console) -> None:
    if options.training is None or results.training is not None:
        return

    def tell(text: str) -> None:
        console.print(Text(text), soft_wrap=True)

    results.training = TrainingSoak(options.out / "training", options.training, options.seed, stop, tell).run()


def _seeds(options: SoakOptions) -> Iterator[int]:
    yield from range(options.seed, options.seed + options.repeat)
