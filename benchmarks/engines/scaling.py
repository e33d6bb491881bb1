"""`python -m benchmarks.engines.scaling`: what a study costs its head, and how many workers one head can keep busy.

Real workers run stub cells that sleep. What a job and a cell cost is measured with two workers; a queueing model then
predicts the rates at 5, 10, 20 and 40 workers, which are measured as well, and extrapolates to 1000.

The model is a closed network: `n_workers * jobs_per_slot` jobs go around between the head, which serves one at a time,
and the workers, which serve as many as there are. Service times are taken as exponential, so the rate is exact:
`rate(K) = G(K - 1) / G(K)` with the normalizing constants `G` of K jobs (Buzen, 1973).
"""

import os
import threading
import time
from collections import defaultdict
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from statistics import fmean, median
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
import psutil
import tyro

from benchmarks.report import write_report
from legpush.study.engines.choose import make_engine
from legpush.study.engines.engine import Engine, Pace
from legpush.study.folder import StudyFolder
from legpush.study.identity import code_version
from legpush.study.jobs import Job, Task
from legpush.study.rows import read_rows
from legpush.study.runner import Runner, Tally

KIND: Final = "benchmarks.engines.study_cells:SLEEP"
PACE: Final = Pace()
N_WARM: Final = 20
"""Most runs in which the workers of an engine may start."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    engines: tuple[str, ...] = ("local", "ray")
    workers: tuple[int, ...] = (5, 10, 20, 40)
    seconds: tuple[float, ...] = (0.1, 0.2)
    """How long a cell sleeps; each is sent alone, so that the head has as much to do as possible."""
    span_s: float = 5.0
    """About how long each measurement takes."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """What was seen in one run of stub cells."""

    n_workers: int
    """Workers that ran a cell."""
    n_cells: int
    cell_s: float
    """Mean time of a cell."""
    cells_per_job: int
    rate_hz: float
    """Cells per second, without the first and the last tenth."""
    head_cpu_s: float
    """CPU time of the head's own process per cell."""
    all_cpu_s: float
    """CPU time of the head, of its workers and of the engine's own processes per cell."""
    cell_cpu_s: float
    """CPU time of the cell itself, as its row has it."""
    gap_s: float
    """Median time between two cells of a worker."""


@dataclass(frozen=True)
class Costs:
    """What an engine costs, from measurements with two workers."""

    head_job_s: float
    """CPU time of the head per job."""
    head_cell_s: float
    """CPU time of the head per cell."""
    worker_job_s: float
    """Time between two jobs in which a worker does not sleep, while the head has nothing else to do."""
    all_job_s: float
    """CPU time of everything per job with a cell: where all runs on one machine, its cores are a limit of their own."""
    start_s: float
    """From nothing to the first answers of two workers."""


class Open:
    """An engine that stays open from one run to the next, and that takes a fixed number of cells at a time."""

    workers_keep_rows = False

    def __init__(self, engine: Engine, cells_per_job: int) -> None:
        self._engine = engine
        self.name = engine.name
        self.pace = Pace(batch_s=1e9, most_cells=cells_per_job)

    def n_slots(self) -> int:
        """Return that of the engine."""
        return self._engine.n_slots()

    def submit(self, job: bytes) -> "Future[bytes]":
        """Pass a job on."""
        return self._engine.submit(job)

    def close(self, *, now: bool) -> None:
        """Leave the engine as it is."""


def measure(engine: Engine, n_cells: int, seconds: float, cells_per_job: int) -> Measured:
    """Run stub cells on an engine."""
    cells = [{"index": index, "seconds": seconds} for index in range(n_cells)]
    tasks = [Task(cell=f"{cell['index']:032x}", inputs=cell, specification=cell) for cell in cells]
    return measure_tasks(engine, KIND, tasks, cells_per_job)


def warm(engine: Engine, n_workers: int) -> None:
    """Run stub cells until each worker has run some."""
    for _ in range(N_WARM):
        if measure(engine, 4 * n_workers, 0.5, 1).n_workers >= n_workers:
            return
    raise RuntimeError(f"Expected {n_workers} workers, got fewer")


def measure_tasks(engine: Engine, kind: str, tasks: Sequence[Task], cells_per_job: int) -> Measured:
    """Run cells of a kind that notes process and times, on an engine that stays open."""
    n_cells = len(tasks)
    with TemporaryDirectory(prefix="legpush-scaling-") as scratch:
        folder = StudyFolder(Path(scratch))
        folder.make_folders()
        began_cpu_s, began_all_s = time.process_time(), cpu_of_all()
        Runner(
            Open(engine, cells_per_job),
            folder,
            job=Job(kind=kind, code=code_version(kind), canary=None, results=None, tasks=()),
            task=lambda index: tasks[index],
            missing=range(n_cells),
            tally=Tally(n_cells=n_cells, n_done=0),
            stop=threading.Event(),
            on_turn=lambda _: None,
            on_canary=lambda _: None,
        ).run()
        head_cpu_s, all_cpu_s = time.process_time() - began_cpu_s, cpu_of_all() - began_all_s
        table = read_rows(folder.part_files())
    rows = [] if table is None else sorted(table.to_pylist(), key=lambda row: row["ended_s"])
    if {row["cell"] for row in rows} != {task.cell for task in tasks}:
        raise RuntimeError(f"Expected {n_cells} cells, got {len(rows)}")
    first, last = n_cells // 10, n_cells - 1 - n_cells // 10
    return Measured(
        n_workers=len({row["pid"] for row in rows}),
        n_cells=n_cells,
        cell_s=fmean(row["ended_s"] - row["began_s"] for row in rows),
        cells_per_job=cells_per_job,
        rate_hz=(last - first) / (rows[last]["ended_s"] - rows[first]["ended_s"]),
        head_cpu_s=head_cpu_s / n_cells,
        all_cpu_s=all_cpu_s / n_cells,
        cell_cpu_s=fmean(row["cpu_s"] for row in rows),
        gap_s=median(_gaps(rows) or [0.0]),
    )


def cpu_of_all() -> float:
    """Return the CPU time of this process and of those that it or its children started."""
    me = psutil.Process()
    times = [process.cpu_times() for process in (me, *me.children(recursive=True))]
    return sum(each.user + each.system for each in times)


def _gaps(rows: list[dict[str, Any]]) -> list[float]:
    by_worker: dict[int, list[dict[str, Any]]] = defaultdict(list)
    for row in rows:
        by_worker[row["pid"]].append(row)
    return [b["began_s"] - a["ended_s"] for each in by_worker.values() for a, b in pairwise(each)]


def measure_costs(on: str) -> Costs:
    """Measure an engine with two workers."""
    began_s = time.perf_counter()
    engine = make_engine(on, 2, Path(), {})
    try:
        measure(engine, 4, 0.0, 1)
        start_s = time.perf_counter() - began_s
        warm(engine, 2)
        alone = measure(engine, 1000, 0.0, 1)
        many = measure(engine, 20_000, 0.0, 250)
        waiting = measure(engine, 100, 0.05, 1)
    finally:
        engine.close(now=True)
    # Cost per cell alone = job + cell; in batches of 250 = job / 250 + cell.
    job_s = (alone.head_cpu_s - many.head_cpu_s) / (1.0 - 1.0 / 250)
    cell_s = alone.head_cpu_s - job_s
    return Costs(job_s, cell_s, worker_job_s=waiting.gap_s, all_job_s=alone.all_cpu_s, start_s=start_s)


def predicted_rate_hz(n_workers: int, seconds: float, cells_per_job: float, costs: Costs) -> float:
    """Return the cells per second that the model predicts, from logarithms of the normalizing constants."""
    head_s = costs.head_job_s + cells_per_job * costs.head_cell_s
    worker_s = costs.worker_job_s + cells_per_job * seconds
    n_jobs = PACE.jobs_per_slot * n_workers
    # The weight of n jobs at the workers is the product of worker_s / min(i, n_workers) for i from 1 to n.
    busy = np.minimum(np.arange(1, n_jobs + 1), n_workers)
    log_workers = np.concatenate([[0.0], np.cumsum(np.log(worker_s) - np.log(busy))])

    def log_g(population: int) -> float:
        n = np.arange(population + 1)
        return float(np.logaddexp.reduce(log_workers[n] + (population - n) * np.log(head_s)))

    return float(np.exp(log_g(n_jobs - 1) - log_g(n_jobs))) * cells_per_job


def extrapolate(costs: Costs) -> list[dict[str, float]]:
    """Return predictions for the batches that the runner makes, up to 1000 workers."""
    rows = []
    for seconds in (0.01, 0.1, 1.0, 10.0):
        cells_per_job = float(max(1, min(round(PACE.batch_s / seconds), PACE.most_cells)))
        for n_workers in (40, 100, 300, 1000, 3000):
            rate_hz = predicted_rate_hz(n_workers, seconds, cells_per_job, costs)
            head_s = costs.head_job_s / cells_per_job + costs.head_cell_s
            rows.append(
                {
                    "n_workers": n_workers,
                    "seconds": seconds,
                    "cells_per_job": cells_per_job,
                    "rate_hz": rate_hz,
                    "busy_workers": rate_hz * seconds / n_workers,
                    "busy_head": rate_hz * head_s,
                }
            )
    return rows


def check(on: str, config: Config, costs: Costs) -> list[dict[str, float]]:
    """Measure with more workers, and compare with the model."""
    rows = []
    for n_workers in config.workers:
        engine = make_engine(on, n_workers, Path(), {})
        try:
            warm(engine, n_workers)
            for seconds in config.seconds:
                model = predicted_rate_hz(n_workers, seconds, 1.0, costs)
                predicted = min(model, len(os.sched_getaffinity(0)) / costs.all_job_s)
                seen = measure(engine, max(100, round(predicted * config.span_s)), seconds, 1)
                row = {
                    **asdict(seen),
                    "model_hz": model,
                    "predicted_hz": predicted,
                    "error": predicted / seen.rate_hz - 1.0,
                }
                rows.append(row)
                print(
                    f"{on} {n_workers} x {seconds} s: {seen.rate_hz:.1f} cells/s, predicted {predicted:.1f}", flush=True
                )
        finally:
            engine.close(now=True)
    return rows


def main(config: Config) -> None:
    """Measure, predict, and write the numbers."""
    load = os.getloadavg()[0]
    # Ray makes its workers nice; where others use the machine too, these would be measured.
    os.environ["RAY_worker_niceness"] = "0"  # noqa: SIM112 - that is its name
    results: dict[str, Mapping[str, Any]] = {}
    for on in config.engines:
        costs = measure_costs(on)
        print(f"{on}: {costs}", flush=True)
        results[on] = {"costs": asdict(costs), "checked": check(on, config, costs), "extrapolated": extrapolate(costs)}
    write_report(
        "scaling",
        {
            "load_before": load,
            "memory_gib": psutil.virtual_memory().total / 2**30,
            "processor": _processor(),
            "jobs_per_slot": PACE.jobs_per_slot,
            "engines": results,
        },
    )


def _processor() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))


if __name__ == "__main__":
    main(tyro.cli(Config))
