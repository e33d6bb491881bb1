"""`python -m benchmarks.engines.engine_overhead`: the CPU time that an engine takes beside the episodes that it runs.

Episodes of pushes of about a second run in plain processes and on each engine, on workers that have run one before. The
CPU time of everything that was started is compared with that of the episodes themselves, in the same run: episodes take
more or less by themselves, by what else the machine does.
"""

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any, Final

import msgspec
import tyro
from threadpoolctl import threadpool_limits

from agent_proc.statistics.intervals import mean
from benchmarks.engines.scaling import cpu_of_all, measure_tasks
from benchmarks.report import write_report
from legpush.study.cells import columns_of, load_kind
from legpush.study.engines.choose import make_engine
from legpush.study.engines.engine import Engine
from legpush.study.file import read_study
from legpush.study.jobs import Task

KIND: Final = "benchmarks.engines.study_cells:PUSH"
STUDY: Final = """
name = "overhead"
[settings]
scenario = "push"
policy = "scripted"
"mission.max_push_cycles" = {cycles}
[axes]
seed = {{ first = {first}, n = {n} }}
"""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    engines: tuple[str, ...] = ("local", "ray")
    n_rounds: int = 3
    n_cells: int = 12
    """Episodes of each measurement."""
    cycles: int = 20
    """Pushes of an episode; twenty take about a second."""
    workers: int = 2


def tasks(config: Config, first: int) -> list[Task]:
    """Return the episodes from a seed on."""
    study = read_study(
        STUDY.format(cycles=config.cycles, first=first, n=config.n_cells),
        "overhead",
        own_cell=KIND,
        allowed_policies=(),
        many=False,
    )
    return list(study.tasks())


def run_plainly(specification: dict[str, Any]) -> float:
    """Run an episode without a study, and return its CPU time."""
    kind = load_kind(KIND)
    with threadpool_limits(limits=1):
        began_s = process_time()
        columns_of(kind, msgspec.convert(specification, kind.resolved))
        return process_time() - began_s


def on_pool(pool: ProcessPoolExecutor, these: list[Task]) -> tuple[float, float]:
    """Run episodes in plain processes; returns CPU seconds of everything and of the episodes, per episode."""
    began_s = cpu_of_all()
    episodes_s = list(pool.map(run_plainly, [task.specification for task in these]))
    return (cpu_of_all() - began_s) / len(these), fmean(episodes_s)


def on_engine(engine: Engine, these: list[Task]) -> tuple[float, float]:
    """Do the same on an engine."""
    seen = measure_tasks(engine, KIND, these, 1)
    return seen.all_cpu_s, seen.cell_cpu_s


def measure_rounds(config: Config, run: Callable[[list[Task]], tuple[float, float]]) -> list[dict[str, float]]:
    """Warm the workers, and run the rounds."""
    run(tasks(config, 0))
    rounds = []
    for index in range(config.n_rounds):
        all_s, episode_s = run(tasks(config, 1000 * (index + 1)))
        rounds.append({"all_cpu_s": all_s, "episode_cpu_s": episode_s, "overhead": all_s / episode_s - 1.0})
    return rounds


def main(config: Config) -> None:
    """Measure, print, and write the numbers."""
    measured = {}
    with ProcessPoolExecutor(config.workers, mp_context=get_context("spawn")) as pool:
        measured["plain"] = measure_rounds(config, partial(on_pool, pool))
    for on in config.engines:
        with TemporaryDirectory() as scratch:
            engine = make_engine(on, config.workers, Path(scratch), {})
            try:
                measured[on] = measure_rounds(config, partial(on_engine, engine))
            finally:
                engine.close(now=True)
    write_report(
        "engine_overhead",
        {
            "n_cells": config.n_cells,
            "cycles": config.cycles,
            "rounds": measured,
            "overhead": {
                name: asdict(mean([each["overhead"] for each in rounds])) for name, rounds in measured.items()
            },
        },
    )


if __name__ == "__main__":
    main(tyro.cli(Config))
