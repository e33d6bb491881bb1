"""`legpush study verify`: runs a random share of the cells again, and compares every number."""

import random
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from rich.console import Console
from rich.text import Text

from legpush.errors import INTERRUPTED, ConfigError, OtherVersionError
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS
from legpush.options.study import VerifyStudy
from legpush.output.reply import document
from legpush.service import stop_on_signals
from legpush.study.engines.choose import SLURM, engine_of, require_engine
from legpush.study.file import Study, read_study
from legpush.study.folder import StudyFolder, StudyRecord
from legpush.study.jobs import Job
from legpush.study.progress import shown
from legpush.study.rows import CELL, differences, joined, read_rows
from legpush.study.runner import Runner, Tally


def verify_study(options: VerifyStudy, console: Console) -> int:
    """Run cells again; returns the exit code.

    Nothing that runs comes from the rows: every cell is made again from the copy of the study file.

    Raises:
        ConfigError: The folder has no study with rows.
        OtherVersionError: Other code ran the study.
        LegpushError: The engine failed.
    """
    require_engine(options.on, options.slurm_options)
    folder, stop = StudyFolder(options.folder), stop_on_signals()
    record = folder.record()
    studies = _studies(options, folder, record)
    places = {task.cell: (study, index) for study in studies for index, task in enumerate(study.tasks())}
    table = folder.rows()
    if table is None:
        raise ConfigError(f"{folder.path}: expected a study with rows, got none")
    cells = table.column(CELL).to_pylist()
    if strange := [cell for cell in cells if cell not in places]:
        _say(console, f"{len(strange)} rows belong to no cell of the study, such as {strange[0]}")
        return 1
    n = max(1, round(options.share * len(cells)))
    chosen = random.Random(options.seed).sample(sorted(cells), n)  # noqa: S311 - no secret
    # Workers on Slurm write their rows where the study is, which all nodes see.
    shared = folder.path if options.on == SLURM else None
    with TemporaryDirectory(prefix="legpush-verify-", dir=shared) as scratch, shown(console) as show:
        again, tally, canaries = StudyFolder(Path(scratch)), Tally(n_cells=n, n_done=0), list[str]()
        again.make_folders()
        Runner(
            engine_of(options, again.path, stop),
            again,
            job=Job(kind=record.kind, code=record.code, canary=None, results=None, tasks=()),
            task=lambda place: places[chosen[place]][0].task(places[chosen[place]][1]),
            missing=range(n),
            tally=tally,
            stop=stop,
            on_turn=show,
            on_canary=canaries.append,
        ).run()
        if stop.is_set():
            _say(console, "interrupted: the other cells are not known")
            return INTERRUPTED
        for canary in canaries:
            if canary != record.canary:
                _say(console, f"this machine computes the canary {canary}, the study had {record.canary}")
        fresh = read_rows(again.row_files(), record.may_differ)
        failed = {failure.cell: failure.error for failure in again.failures()}
    tables = [table] if fresh is None else [table.take(_places(cells, chosen)), fresh]
    n_fresh = 0 if fresh is None else fresh.num_rows
    rows = joined(tables).to_pylist()
    stored, computed = rows[: len(rows) - n_fresh], {row[CELL]: row for row in rows[len(rows) - n_fresh :]}
    lines = list(_compared(stored, computed, failed, table.column_names, record))
    for line in lines:
        _say(console, line)
    _say(console, f"{n - len(lines)} of {n} cells are equal, of {len(cells)} in the study")
    document({"n_equal": n - len(lines), "n_verified": n, "n_cells": len(cells), "differences": lines})
    return 1 if lines else 0


def _studies(options: VerifyStudy, folder: StudyFolder, record: StudyRecord) -> list[Study]:
    """Read the study files in the folder, and check that this is the code that ran them."""
    studies = [
        read_study(source, str(folder.path), own_cell=options.cell, allowed_policies=options.policy, many=True)
        for source in folder.sources()
    ]
    for study in studies:
        if study.kind_name != record.kind:
            raise ConfigError(f"{folder.path}: expected cells of the kind {record.kind}, got {study.kind_name}")
        if study.code != record.code:
            raise _other_version(folder, record, study.code)
    return studies


def _other_version(folder: StudyFolder, record: StudyRecord, code: str) -> OtherVersionError:
    """Return the error of a study that other code ran; it names the versions of code and motions."""
    motions = record.versions.get(MOTIONS) or "not noted"
    return OtherVersionError(
        f"{folder.path}: other version: run by code version {record.code} (motion version {motions}), here is {code} "
        f"({MOTION_VERSION}); its cells cannot be run again here, `legpush study table` shows them as before"
    )


def _places(cells: Sequence[str], chosen: Sequence[str]) -> list[int]:
    place = {cell: index for index, cell in enumerate(cells)}
    return [place[cell] for cell in chosen]


def _compared(
    stored: Sequence[Mapping[str, Any]],
    computed: Mapping[str, Mapping[str, Any]],
    failed: Mapping[str, str],
    columns: Sequence[str],
    record: StudyRecord,
) -> Iterator[str]:
    """Yield a line for each cell that is not the same again."""
    for row in stored:
        cell = row[CELL]
        if cell not in computed:
            yield f"cell {cell} fails now: {failed.get(cell, 'unknown')}"
            continue
        now = computed[cell]
        if different := differences(row, {name: now[name] for name in columns}, record.may_differ):
            shown = ", ".join(f"{name} (stored {row[name]!r}, computed {now[name]!r})" for name in different)
            yield f"cell {cell} differs in {shown}"


def _say(console: Console, text: str) -> None:
    console.print(Text(text), soft_wrap=True)
