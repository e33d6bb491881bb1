"""Trainings with several seeds, `legpush train --seeds`: a study whose cells go on where they were interrupted."""

import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from agent_proc.learning.training_plan import again
from agent_proc.programs.render_films import render_films
from agent_proc.statistics.estimate import Estimate
from agent_proc.studies.seed_trainings import (
    MEASURES,
    STUDY,
    progress_text,
    seed_folder,
    study_text,
    summarize_seeds,
    write_summary,
)
from legpush.errors import INTERRUPTED
from legpush.files import make_folder
from legpush.options.checks import require_writable_folder
from legpush.options.learning import TrainOptions
from legpush.output.reply import document
from legpush.scenarios.changes import parse_changes
from legpush.service import stop_on_signals
from legpush.study.carry_out import Orders, carry_out
from legpush.study.engines.local import LocalEngine
from legpush.study.file import read_study
from legpush.study.folder import StudyFolder
from legpush.study.progress import line, shown

FILE_SUFFIX = ".toml"


def begin_seeds(options: TrainOptions, seeds: Sequence[int], folder: Path, console: Console) -> int:
    """Train with each seed in `folder`, or go on there; returns the exit code.

    Raises:
        ConfigError: An option cannot be used, or the folder has other trainings.
        LegpushError: A training, a policy or the world cannot be used.
    """
    require_writable_folder(folder, "--out")
    source = study_text(_settings(options), seeds)
    if options.dry_run:
        n_cells = read_study(source, "--seeds", allowed_policies=(*options.loggers, *options.callbacks)).n_cells
        console.print(Text(source), soft_wrap=True)
        document({"folder": folder, "study": source, "n_trainings": n_cells})
        return 0
    return _train(source, options, folder, console)


def resume_seeds(options: TrainOptions, console: Console) -> int:
    """Go on with the trainings in the folder that `--resume` names; returns the exit code."""
    folder = options.resume
    assert folder is not None  # noqa: S101 - the caller has looked
    require_writable_folder(folder, "--resume")
    (source,) = StudyFolder(folder / STUDY).sources()
    return _train(source, options, folder, console)


def _settings(options: TrainOptions) -> dict[str, Any]:
    """The options as settings of a cell; paths are absolute, so that the study can go on from any directory."""
    return {
        "profile": _anywhere(options.profile),
        "task": _anywhere(options.task),
        "entry": options.entry,
        "actions": options.actions,
        "steps": options.steps,
        "mass_kg": options.mass_kg,
        "friction": options.friction,
        "distance_m": options.distance_m,
        "scenario": _anywhere(options.scenario),
        "world": options.world,
        "init": None if options.init is None else _existing(options.init),
        "n_simulators": options.n_simulators,
        "loggers": list(options.loggers),
        "callbacks": list(options.callbacks),
        "film_every": options.film_every,
        "film_last": options.film_last,
        **parse_changes(options.changes),
    }


def _anywhere(name: str | None) -> str | None:
    """A path as an absolute one; a name as it is."""
    is_path = name is not None and ("/" in name or name.endswith(FILE_SUFFIX))
    return os.path.abspath(name) if is_path and name is not None else name


def _existing(name: str) -> str:
    return os.path.abspath(name) if Path(name).is_dir() else name


def _train(source: str, options: TrainOptions, folder: Path, console: Console) -> int:
    allowed = (*options.loggers, *options.callbacks)
    study, stop = read_study(source, f"{folder / STUDY}", allowed_policies=allowed), stop_on_signals()
    seeds: list[int] = study.file.axes["seed"]
    command = again(folder, options.loggers, options.callbacks)
    n_workers = min(options.workers or len(os.sched_getaffinity(0)), len(seeds))
    orders = Orders(
        engine=lambda _: LocalEngine(n_workers),
        stop=stop,
        again=command,
        retry_failed=True,
        shown=partial(shown, console, partial(progress_text, folder, seeds)),
        folder_of=lambda task: seed_folder(folder, task.inputs["seed"]),
    )
    study.task(0)
    make_folder(folder, private=options.out is None)
    tally = carry_out(study, folder / STUDY, orders)
    if stop.is_set():
        console.print(Text(f"interrupted: {line(tally, 0.0)}; to go on: {command}"), soft_wrap=True)
        return INTERRUPTED
    for failure in StudyFolder(folder / STUDY).failures():
        console.print(Text(f"seed {failure.inputs['seed']} failed: {failure.error}"), soft_wrap=True)
    is_filmed = all(render_films(seed_folder(folder, seed), console, command, stop) for seed in seeds)
    if tally.n_done:
        _report(folder, summarize_seeds(folder), console)
    if not is_filmed:
        return INTERRUPTED
    return 1 if tally.n_failed else 0


def _report(folder: Path, summary: Mapping[str, Estimate], console: Console) -> None:
    """Print and write the means over the seeds."""
    table = Table(box=None, padding=(0, 2, 0, 0), title_justify="left")
    table.add_column("best policies, mean over seeds")
    for title in ("n", "value", "95 % interval"):
        table.add_column(title, justify="right")
    table.add_column("how")
    for measure in MEASURES:
        estimate = summary[measure.column].scaled(measure.scale)
        number = f".{measure.n_digits}f"
        low, high = estimate.low, estimate.high
        interval = "-" if low is None or high is None else f"{low:{number}} to {high:{number}}"
        name = f"{measure.name} [{measure.unit}]" if measure.unit else measure.name
        table.add_row(*map(Text, (name, str(estimate.n), f"{estimate.value:{number}}", interval, estimate.kind)))
    console.print(table)
    console.print(
        Text(f"on the starts by which each training chose its best policy; on others: legpush compare {folder}"),
        soft_wrap=True,
    )
    console.print(Text(f"wrote {write_summary(folder, summary)}"), soft_wrap=True)
    document({"folder": folder, "mean_over_seeds": summary})
