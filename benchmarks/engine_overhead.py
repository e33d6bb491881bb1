"""`python -m benchmarks.engine_overhead`: what engines cost beside the episodes of pushes that they run.

Episodes of about a second run in plain processes and on each engine, in turn, on workers that have run one before.
Costs are CPU seconds of everything that was started, per episode: on a machine that does other things too, wall time
says little.
"""

import json
import os
import platform
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Final

import msgspec
import tyro
from threadpoolctl import threadpool_limits

from agent_proc.statistics import mean_interval
from benchmarks.scaling import Measured, cpu_of_all, measure_tasks
from legpush.study.cells import columns_of, load_kind
from legpush.study.engines.choose import make_engine
from legpush.study.engines.engine import Engine
from legpush.study.file import read_study
from legpush.study.jobs import Task
from legpush.versions import installed_versions

KIND: Final = "benchmarks.study_cells:PUSH"
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
    n_rounds: int = 4
    n_cells: int = 16
    """Episodes of each measurement."""
    cycles: int = 10
    """Pushes of an episode; ten take about a second."""
    workers: int = 2
    out: Annotated[Path, tyro.conf.arg(metavar="JSON")] = Path("benchmarks/results/engine_overhead.json")
    """Where the numbers go."""


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


def run_plainly(specification: dict[str, Any]) -> None:
    """Run an episode without a study."""
    kind = load_kind(KIND)
    with threadpool_limits(limits=1):
        columns_of(kind, msgspec.convert(specification, kind.resolved))


def on_pool(pool: ProcessPoolExecutor) -> Callable[[list[Task]], float]:
    """Return a function that runs episodes in plain processes, and returns the CPU seconds of each."""

    def run(these: list[Task]) -> float:
        began_s = cpu_of_all()
        list(pool.map(run_plainly, [task.specification for task in these]))
        return (cpu_of_all() - began_s) / len(these)

    return run


def on_engine(engine: Engine) -> Callable[[list[Task]], float]:
    """Return the same for an engine."""

    def run(these: list[Task]) -> float:
        seen: Measured = measure_tasks(engine, KIND, these, 1)
        return seen.all_cpu_s

    return run


def main(config: Config) -> None:
    """Measure, print, and write the numbers."""
    pool = ProcessPoolExecutor(config.workers, mp_context=get_context("spawn"))
    cpu_s: dict[str, list[float]] = {}
    with TemporaryDirectory() as scratch:
        engines = {on: make_engine(on, config.workers, Path(scratch), {}) for on in config.engines}
        runs = {"plain": on_pool(pool), **{on: on_engine(engine) for on, engine in engines.items()}}
        try:
            for run in runs.values():
                run(tasks(config, 0)[: 2 * config.workers])
            for index in range(config.n_rounds):
                these = tasks(config, 1000 * (index + 1))
                for name, run in runs.items():
                    cpu_s.setdefault(name, []).append(run(these))
                    print(f"{name}: {cpu_s[name][-1]:.4f} s per episode", flush=True)
        finally:
            for engine in engines.values():
                engine.close(now=True)
            pool.shutdown()
    over = {
        name: mean_interval([mine / plain - 1.0 for mine, plain in zip(cpu_s[name], cpu_s["plain"], strict=True)])
        for name in config.engines
    }
    for name, interval in over.items():
        print(f"{name}: {interval.value:.1%} [{interval.low:.1%}, {interval.high:.1%}] over plain processes")
    content = {
        "command": "python -m benchmarks.engine_overhead",
        "machine": {"system": platform.platform(), "cores": os.cpu_count(), "load": os.getloadavg()[0]},
        "versions": installed_versions(),
        "n_cells": config.n_cells,
        "cycles": config.cycles,
        "cpu_s_per_episode": cpu_s,
        "overhead": {name: [interval.value, interval.low, interval.high] for name, interval in over.items()},
    }
    config.out.write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main(tyro.cli(Config))
