"""Carries out a study in its folder: runs what is missing on an engine, and writes all rows into one table."""

import errno
import hashlib
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path

import msgspec

from legpush.canary import compute
from legpush.errors import ConfigError, DiskFullError
from legpush.files import DiskError
from legpush.study.engines.engine import Engine
from legpush.study.file import Study
from legpush.study.folder import StudyFolder, StudyRecord
from legpush.study.identity import study_versions
from legpush.study.jobs import Job, Task
from legpush.study.rows import described, in_order, write_table
from legpush.study.runner import Runner, Tally

Show = Callable[[Tally], None]


def _silent() -> AbstractContextManager[Show]:
    """Show nothing."""
    return nullcontext(lambda _: None)


@dataclass(frozen=True, kw_only=True)
class Orders:
    """How a study is carried out."""

    engine: Callable[[Path], Engine]
    """Makes the engine, of the folder of the study; called only if a cell is missing."""
    stop: threading.Event
    """Ends the study early; every finished cell is kept."""
    again: str
    """The command that goes on."""
    first_decides: bool = True
    """Whether the canary of the first worker is that of the study; otherwise it is that of this process."""
    retry_failed: bool = False
    """Run again the cells that failed by themselves."""
    shown: Callable[[], AbstractContextManager[Show]] = _silent
    """Shows how far the study is."""
    private: bool = False
    """Whether only the user can enter the folder of the study, if it is new."""
    folder_of: Callable[[Task], Path] | None = None
    """Folder in which a cell keeps its work; it outlives the study. Workers see the same disk."""


def carry_out(study: Study, path: Path, orders: Orders) -> Tally:
    """Begin the study in a folder, or go on with it, until each cell has a row or has failed, or the stop is set.

    Raises:
        ConfigError: The cells cannot be made, or the folder cannot be used; nothing was run.
        DiskFullError: The disk is full; what was written before is kept.
        LegpushError: The engine failed.
    """
    cells = [task.cell for task in study.tasks()]
    _require_different(study, cells)
    folder = StudyFolder(path)
    with folder.opened((study.source,), study_record(study, cells, orders.again), private=orders.private):
        try:
            tally = _run_missing(study, cells, folder, orders)
            if not orders.stop.is_set():
                merge_parts(folder, cells)
        except DiskError as error:
            if getattr(error.__cause__, "errno", None) in (errno.ENOSPC, errno.EDQUOT):
                raise DiskFullError(f"{error}; to go on: {orders.again}") from error
            raise
    return tally


def study_record(study: Study, cells: Sequence[str], command: str) -> StudyRecord:
    """Make the record of a study that begins here."""
    return StudyRecord(
        name=study.file.name,
        kind=study.kind_name,
        n_cells=len(cells),
        cells_sha256=hashlib.sha256("".join(cells).encode()).hexdigest(),
        code=study.code,
        inputs=tuple(study.task(0).inputs),
        axes=tuple(path for axis in study.axes for path in axis.columns),
        may_differ=tuple(column.name for column in study.kind.columns if column.may_differ),
        units={column.name: column.unit for column in study.kind.columns if column.unit},
        canary=None,
        versions=study_versions(),
        command=command,
    )


def merge_parts(folder: StudyFolder, cells: Sequence[str]) -> None:
    """Write all rows into one table, in the order of the cells, and then remove the parts.

    Raises:
        DiskError: The table cannot be written; the parts are kept.
        RowsError: The rows of a cell differ.
    """
    parts = folder.part_files()
    record = folder.record()
    table = folder.rows() if parts else None
    if table is not None:
        about = msgspec.json.encode(record).decode()
        write_table(described(in_order(table, cells), record.units, about), folder.table)
        folder.remove_parts(parts)


def _run_missing(study: Study, cells: Sequence[str], folder: StudyFolder, orders: Orders) -> Tally:
    """Run the cells that have neither a row nor a failure that stays."""
    done = folder.done()
    if others := done - set(cells):
        raise ConfigError(f"{folder.path}: expected rows of this study, got those of {len(others)} other cells")
    failed = {failure.cell: failure for failure in folder.failures()}
    retried = [cell for cell, failure in failed.items() if orders.retry_failed or not failure.own or cell in done]
    stays = failed.keys() - set(retried)
    missing = [index for index, cell in enumerate(cells) if cell not in done and cell not in stays]
    tally = Tally(n_cells=len(cells), n_done=len(done), n_failed=len(stays))
    folder.require_space(len(missing))
    folder.forget_failures(retried)
    if missing:
        job = Job(
            kind=study.kind_name,
            code=study.code,
            canary=_expected_canary(orders, study, folder),
            results=study.file.results,
            tasks=(),
        )
        with orders.shown() as show:
            Runner(
                orders.engine(folder.path),
                folder,
                job=job,
                task=_placed(study, orders),
                missing=missing,
                tally=tally,
                stop=orders.stop,
                on_turn=show,
                on_canary=folder.set_canary,
            ).run()
    return tally


def _placed(study: Study, orders: Orders) -> Callable[[int], Task]:
    """Return what makes a cell by its index, with the folder in which it keeps its work."""
    if (folder_of := orders.folder_of) is None:
        return study.task

    def task(index: int) -> Task:
        made = study.task(index)
        return msgspec.structs.replace(made, folder=str(folder_of(made).absolute()))

    return task


def _expected_canary(orders: Orders, study: Study, folder: StudyFolder) -> str | None:
    """Return the CRC that the canary of each worker must have; None leaves it to the first worker."""
    if (expected := folder.record().canary) is None and study.kind.needs_canary and not orders.first_decides:
        expected = compute().crc
        folder.set_canary(expected)
    return expected


def _require_different(study: Study, cells: Sequence[str]) -> None:
    seen: dict[str, int] = {}
    for index, cell in enumerate(cells):
        if (first := seen.setdefault(cell, index)) != index:
            a, b = study.values(first), study.values(index)
            raise ConfigError(f"{study.where}: expected different cells, got equal ones for {a} and {b}")
