"""Work whose rows a worker keeps in the folder of the study by itself, without a head that takes them."""

from collections.abc import Sequence
from pathlib import Path
from time import monotonic
from typing import Final

from msgspec.structs import replace

from legpush.study.jobs import Failure, Row, Task, decode_answer, decode_job, encode
from legpush.study.rows import CELL, SUFFIX, read_rows, write_part
from legpush.study.work import work

FLUSH_S: Final = 20.0
"""Longest time that a finished row waits to be written."""


def work_and_keep(parts: Path, payload: bytes, *, again: bool) -> bytes:
    """Run the cells of a job one after the other, write their rows into `parts`, and return the answer.

    A job that is started `again` leaves out the cells whose rows are there, and answers with these.
    """
    job = decode_job(payload)
    kept = _rows_of(parts, {task.cell for task in job.tasks}) if again else {}
    rows, failures, waiting = list(kept.values()), list[Failure](), list[Row]()
    began_s = monotonic()
    for group in _one_by_one([task for task in job.tasks if task.cell not in kept]):
        answer = decode_answer(work(encode(replace(job, tasks=group))))
        rows += answer.rows
        failures += answer.failures
        waiting += answer.rows
        if answer.refused is not None:
            break
        if monotonic() - began_s >= FLUSH_S:
            _write(parts, waiting)
            waiting, began_s = [], monotonic()
    _write(parts, waiting)
    return encode(replace(answer, rows=tuple(rows), failures=tuple(failures)))


def _one_by_one(tasks: Sequence[Task]) -> list[tuple[Task, ...]]:
    """Return groups of one task; an empty group if there is no task, so that the worker says what it is."""
    return [(task,) for task in tasks] or [()]


def _write(parts: Path, rows: Sequence[Row]) -> None:
    if rows:
        write_part(parts, [row.columns for row in rows])


def _rows_of(parts: Path, cells: set[str]) -> dict[str, Row]:
    """Return the rows that are kept already, by cell."""
    table = read_rows(sorted(parts.glob(f"*{SUFFIX}")))
    found = [] if table is None else table.to_pylist()
    return {row[CELL]: Row(cell=row[CELL], columns=row, wall_s=row["wall_s"]) for row in found if row[CELL] in cells}
