"""`legpush study run`: begins a study, or goes on with it, until every cell has a row or has failed."""

import errno
import hashlib
import shlex
import sys
import threading
from collections.abc import Sequence

import msgspec
from rich.console import Console
from rich.text import Text

from legpush.canary import compute
from legpush.errors import INTERRUPTED, ConfigError, DiskFullError
from legpush.files import DiskError
from legpush.options.checks import require_writable_folder
from legpush.options.study import RunStudy
from legpush.output.reply import document
from legpush.service import stop_on_signals
from legpush.study.engines.choose import INLINE, LOCAL, make_engine, require_engine
from legpush.study.file import Study, load_study
from legpush.study.folder import StudyFolder, StudyRecord
from legpush.study.identity import study_versions
from legpush.study.jobs import Job
from legpush.study.progress import line, shown
from legpush.study.rows import described, in_order, write_table
from legpush.study.runner import Runner, Tally


def run_study(options: RunStudy, console: Console) -> int:
    """Run the study; returns the exit code.

    Raises:
        ConfigError: The file, the folder or the engine cannot be used; nothing was run.
        DiskFullError: The disk is full; what was written before is kept.
        LegpushError: The engine failed.
    """
    require_engine(options.on, options.slurm_options)
    require_writable_folder(options.folder, "--out")
    study = load_study(options.file, own_cell=options.cell, allowed_policies=options.policy, many=options.yes)
    cells = [task.cell for task in study.tasks()]
    _require_different(study, cells)
    stop, folder = stop_on_signals(), StudyFolder(options.folder)
    again = shlex.join(["legpush", *sys.argv[1:]])
    with folder.opened((study.source,), study_record(study, cells, again)):
        try:
            tally = _run_missing(options, study, cells, folder, stop, console)
            if stop.is_set():
                console.print(Text(f"interrupted: {line(tally, 0.0)}; to go on: {again}"), soft_wrap=True)
                return INTERRUPTED
            merge_parts(folder, cells)
        except DiskError as error:
            if getattr(error.__cause__, "errno", None) in (errno.ENOSPC, errno.EDQUOT):
                raise DiskFullError(f"{error}; to go on: {again}") from error
            raise
    console.print(Text(f"{line(tally, 0.0)}; written to {folder.table}"), soft_wrap=True)
    document({"table": folder.table, "n_cells": tally.n_cells, "n_done": tally.n_done, "n_failed": tally.n_failed})
    if tally.n_failed:
        console.print(Text(f"failed cells have their last words in {folder.failed}"), soft_wrap=True)
        return 1
    return 0


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


def _run_missing(
    options: RunStudy,
    study: Study,
    cells: Sequence[str],
    folder: StudyFolder,
    stop: threading.Event,
    console: Console,
) -> Tally:
    """Run the cells that have neither a row nor a failure that stays."""
    done = folder.done()
    if others := done - set(cells):
        raise ConfigError(f"{folder.path}: expected rows of this study, got those of {len(others)} other cells")
    failed = {failure.cell: failure for failure in folder.failures()}
    retried = [cell for cell, failure in failed.items() if options.retry_failed or not failure.own or cell in done]
    stays = failed.keys() - set(retried)
    missing = [index for index, cell in enumerate(cells) if cell not in done and cell not in stays]
    tally = Tally(n_cells=len(cells), n_done=len(done), n_failed=len(stays))
    folder.require_space(len(missing))
    folder.forget_failures(retried)
    if missing:
        job = Job(
            kind=study.kind_name,
            code=study.code,
            canary=_expected_canary(options, study, folder),
            results=study.file.results,
            tasks=(),
        )
        with shown(console) as show:
            Runner(
                make_engine(options.on, options.n_workers, folder.path, options.slurm_options),
                folder,
                job=job,
                task=study.task,
                missing=missing,
                tally=tally,
                stop=stop,
                on_turn=show,
                on_canary=folder.set_canary,
            ).run()
    return tally


def _expected_canary(options: RunStudy, study: Study, folder: StudyFolder) -> str | None:
    """Return the CRC that the canary of each worker must have: that of the study, or on a cluster that of this machine.

    None leaves it to the first worker, which is a process of this machine.
    """
    if (expected := folder.record().canary) is None and study.kind.needs_canary and options.on not in (LOCAL, INLINE):
        expected = compute().crc
        folder.set_canary(expected)
    return expected


def _require_different(study: Study, cells: Sequence[str]) -> None:
    seen: dict[str, int] = {}
    for index, cell in enumerate(cells):
        if (first := seen.setdefault(cell, index)) != index:
            a, b = study.values(first), study.values(index)
            raise ConfigError(f"{study.where}: expected different cells, got equal ones for {a} and {b}")
