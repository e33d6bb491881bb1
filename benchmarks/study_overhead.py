"""`python -m benchmarks.study_overhead`: cells of about one second in a study against plain processes.

CPU seconds: episodes of pushes, as a study and as one plain process per worker, each with its share of the same cells;
whole programs with everything that they start, in turn. Wall time: cells that only sleep, in workers that run already,
in turn with plain processes, so that what they take beyond their sleep does not depend on other work of the machine.
The numbers go to `results/study_overhead.json`.
"""

import resource
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.synchronize import Event, Semaphore
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any, Final

import msgspec
import tyro

from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import mean
from agent_proc.statistics.paired import paired_ratio
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.study.engines.local import LocalEngine
from legpush.study.file import Study, load_study, read_study
from legpush.study.folder import StudyFolder
from legpush.study.jobs import Job
from legpush.study.runner import Runner, Tally

STUB: Final = "tests.legpush.study.stub:STUB"
PUSHES: Final = """
name = "overhead"
cell = "push"
[settings]
scenario = "push"
policy = "scripted"
"mission.max_push_cycles" = {cycles}
[axes]
seed = {{ first = {first}, n = {n} }}
"""
SLEEPS: Final = """
name = "sleep"
[settings]
seconds = 1.0
[axes]
seed = {{ first = 0, n = {n} }}
"""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    n_pairs: int = 4
    n_cells: int = 20
    """Cells of each program."""
    cycles: int = 20
    """Pushes of an episode; twenty take about a second."""
    workers: int = 2


def main(config: Config) -> None:
    """Measure and report the numbers."""
    pairs = []
    for index in range(config.n_pairs):
        text = PUSHES.format(cycles=config.cycles, first=1000 * index, n=config.n_cells)
        study_s, plain_s = as_study(text, config.workers), as_plain_processes(text, config.workers)
        pairs.append({"study_cpu_s": study_s, "plain_cpu_s": plain_s})
        print(f"CPU: {study_s:.1f} s as a study, {plain_s:.1f} s in plain processes", flush=True)
    sleeps = []
    for _ in range(2 * config.n_pairs):
        study_s, head_s = sleeping(config.n_cells, config.workers)
        plain_s = sleeping_plainly(config.n_cells, config.workers)
        sleeps.append({"study_wall_s": study_s, "plain_wall_s": plain_s, "head_cpu_s_per_cell": head_s})
    write_report(
        "study_overhead",
        {
            "cpu_over_plain": plain(_ratio(pairs, "study_cpu_s", "plain_cpu_s"), 4),
            "wall_over_plain": plain(_ratio(sleeps, "study_wall_s", "plain_wall_s"), 5),
            "head_cpu_s_per_cell": plain(mean([pair["head_cpu_s_per_cell"] for pair in sleeps]), 6),
            "pairs": pairs,
            "sleeping_pairs": sleeps,
        },
    )


def _ratio(pairs: Sequence[dict[str, float]], over: str, under: str) -> Estimate:
    """Geometric mean of the ratios of two measures, pair by pair."""
    first, second = (dict(enumerate(pair[key] for pair in pairs)) for key in (over, under))
    return paired_ratio(first, second)


def as_study(text: str, workers: int) -> float:
    """CPU seconds of `legpush study run`."""
    with TemporaryDirectory(prefix="legpush-overhead-") as scratch:
        file = Path(scratch) / "study.toml"
        file.write_text(text)
        command = [str(Path(sys.executable).with_name("legpush")), "study", "run", str(file)]
        return _cpu_s([*command, "--out", str(Path(scratch) / "out"), "--workers", str(workers)])


def as_plain_processes(text: str, workers: int) -> float:
    """CPU seconds of a program that shares out the cells among processes, and does nothing else."""
    with TemporaryDirectory(prefix="legpush-overhead-") as scratch:
        file = Path(scratch) / "study.toml"
        file.write_text(text)
        return _cpu_s([sys.executable, "-m", "benchmarks.study_overhead", "plain", str(file), str(workers)])


def run_plainly(file: Path, workers: int) -> None:
    """Be the plain program: resolve the cells, and run each share in a process."""
    study = load_study(file)
    cells = [task.specification for task in study.tasks()]
    context = get_context("spawn")
    processes = [context.Process(target=run_share, args=(str(file), cells[index::workers])) for index in range(workers)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
        if process.exitcode != 0:
            raise RuntimeError(f"A plain process ended with {process.exitcode}")


def run_share(file: str, cells: list[dict[str, Any]]) -> None:
    """Run cells one after the other."""
    kind = load_study(Path(file)).kind
    for cell in cells:
        kind.run(msgspec.convert(cell, kind.resolved))


def sleeping(n_cells: int, workers: int) -> tuple[float, float]:
    """Wall time of sleeping cells in a study whose workers run already, and CPU seconds of the head for each."""
    study = read_study(SLEEPS.format(n=n_cells + workers), "sleep", own_cell=STUB)
    engine = LocalEngine(workers)
    with TemporaryDirectory(prefix="legpush-overhead-") as scratch:
        folder = StudyFolder(Path(scratch))
        folder.make_folders()
        warm = [engine.submit(msgspec.msgpack.encode(_job(study))) for _ in range(workers)]
        for future in warm:
            future.result()
        runner = _runner(study, engine, folder, n_cells)
        began_s, began_cpu_s = perf_counter(), process_time()
        runner.run()
        return perf_counter() - began_s, (process_time() - began_cpu_s) / n_cells


def sleeping_plainly(n_cells: int, workers: int) -> float:
    """Wall time of the same cells in plain processes that run already, up to the end of the last one."""
    context = get_context("spawn")
    ready, go = context.Semaphore(0), context.Event()
    text = SLEEPS.format(n=n_cells)
    processes = [
        context.Process(target=sleep_share, args=(text, index, workers, ready, go)) for index in range(workers)
    ]
    for process in processes:
        process.start()
    for _ in processes:
        ready.acquire()
    began_s = perf_counter()
    go.set()
    for process in processes:
        process.join()
    return perf_counter() - began_s


def sleep_share(text: str, index: int, workers: int, ready: Semaphore, go: Event) -> None:
    """Wait for the beginning, and run every n-th cell."""
    study = read_study(text, "sleep", own_cell=STUB)
    cells = [task.specification for task in study.tasks()][index::workers]
    ready.release()
    go.wait()
    for cell in cells:
        study.kind.run(msgspec.convert(cell, study.kind.resolved))


def _job(study: Study) -> Job:
    return Job(kind=study.kind_name, code=study.code, canary=None, results=None, tasks=())


def _runner(study: Study, engine: LocalEngine, folder: StudyFolder, n_cells: int) -> Runner:
    return Runner(
        engine,
        folder,
        job=_job(study),
        task=study.task,
        missing=range(n_cells),
        tally=Tally(n_cells=n_cells, n_done=0),
        stop=threading.Event(),
    )


def _cpu_s(command: list[str]) -> float:
    """CPU seconds of a program and everything that it starts."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    if sys.argv[1:2] == ["plain"]:
        run_plainly(Path(sys.argv[2]), int(sys.argv[3]))
    else:
        main(tyro.cli(Config))
