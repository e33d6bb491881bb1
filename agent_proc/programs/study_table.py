"""Tables of studies as a program: `legpush study table`."""

import io
from typing import Final

from rich.console import Console
from rich.table import Table
from rich.text import Text

from agent_proc.studies.picture import save_picture
from agent_proc.studies.table import as_csv, groups_of, make_table, measures_of, pairing_of, read_study_rows
from legpush.files import write_whole
from legpush.options.study import StudyTable
from legpush.output.reply import document
from legpush.service import run_command
from legpush.study.folder import StudyFolder

MOST_WIDTH: Final = 1000
"""A table is never cut to the width of a terminal."""


def main() -> int:
    """Parse the command line and print the table; returns the exit code."""
    return run_command("study table", StudyTable, lambda options: run(options, Console()))


def run(options: StudyTable, console: Console) -> int:
    """Print the table, and write and draw it if asked; returns the exit code.

    Raises:
        ConfigError: A column cannot be used, or the folder has no study.
        RowsError: Rows cannot be read or differ.
        DiskError: The table cannot be written.
    """
    study = read_study_rows(StudyFolder(options.folder))
    pairing = None if options.paired is None else pairing_of(study, options.paired)
    by = groups_of(study, options.by, pairing)
    lines = make_table(study, by, measures_of(study, options.measure), pairing)
    table = Table(box=None, padding=(0, 2, 0, 0))
    for title in ("measure", *by):
        table.add_column(Text(title), no_wrap=True)
    for title in ("n", "value", "95 % interval"):
        table.add_column(Text(title), justify="right", no_wrap=True)
    table.add_column(Text("how"), no_wrap=True)
    for line in lines:
        estimate = line.estimate
        values = (str(line.group[column]) for column in by)
        low, high = estimate.low, estimate.high
        interval = "-" if low is None or high is None else f"{low:.4g} to {high:.4g}"
        table.add_row(*map(Text, (line.title, *values, str(estimate.n), f"{estimate.value:.4g}", interval, line.how)))
    wide = Console(file=io.StringIO(), width=MOST_WIDTH)
    with wide.capture() as text:
        wide.print(table)
    for row in text.get().splitlines():
        console.print(Text(row.rstrip()), soft_wrap=True)
    n_rows, record = len(study.rows), study.record
    document({"n_rows": n_rows, "n_cells": record.n_cells, "lines": lines})
    if n_rows < record.n_cells:
        console.print(Text(f"{n_rows} of {record.n_cells} cells have a row"), soft_wrap=True)
    if options.csv is not None:
        write_whole(options.csv, as_csv(lines, by).encode())
        console.print(Text(f"wrote {options.csv}"), soft_wrap=True)
    if options.plot is not None:
        what = f", differences from {options.paired}" if options.paired else ""
        save_picture(lines, by, f"{record.name}{what}, {n_rows} cells, 95 % intervals", options.plot)
        console.print(Text(f"wrote {options.plot}"), soft_wrap=True)
    return 0
