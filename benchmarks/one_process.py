"""`python -m benchmarks.one_process`: a mission in one process against the same mission in three.

Both are whole programs, from the start of the interpreter to the result, without picture and film, in turn. CPU seconds
are those of the program and its children; steps per second are simulated steps per second of the mission itself. The
numbers go to `results/one_process.json`.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import tyro

from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import median
from agent_proc.statistics.paired import common, paired_ratio
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.processes.environment import child_environment

IN_ONE = """
import json, sys, legpush
run = legpush.run(sys.argv[1], seed=int(sys.argv[2]))
print(json.dumps({"wall_time_s": run.report.wall_time_s, "state_crc": run.state_crc}))
"""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    scenario: str = "default"
    """The mission."""
    n_pairs: int = 8
    """Pairs, each with a seed of its own, from 0."""


def main(config: Config) -> None:
    """Measure and report the numbers."""
    pairs: list[tuple[Measured, Measured]] = []
    for seed in range(config.n_pairs):
        one, three = in_one_process(config.scenario, seed), in_three(config.scenario, seed)
        if one.state_crc != three.state_crc:
            raise RuntimeError(f"Seed {seed}: {one.state_crc} in one process, {three.state_crc} in three")
        pairs.append((one, three))
        print(f"seed {seed}: CPU {one.cpu_s:.1f} s and {three.cpu_s:.1f} s, CRC {one.state_crc}", flush=True)
    write_report(
        "one_process",
        {
            "scenario": config.scenario,
            "ratios": {
                name: {statistic: plain(estimate, 4) for statistic, estimate in statistics.items()}
                for name, statistics in ratios_of(pairs).items()
            },
            "pairs": [
                {"seed": seed, "one": asdict(one), "three": asdict(three)} for seed, (one, three) in enumerate(pairs)
            ],
        },
    )


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One run of a program."""

    cpu_s: float
    """Of the program and its children."""
    wall_time_s: float
    """Of the mission alone."""
    state_crc: str


def ratios_of(pairs: Sequence[tuple[Measured, Measured]]) -> dict[str, dict[str, Estimate]]:
    """CPU time and speed of one process over those of three, by seeds: median and geometric mean."""
    cpu_s = [dict(enumerate(run.cpu_s for run in runs)) for runs in zip(*pairs, strict=True)]
    speed_hz = [dict(enumerate(1.0 / run.wall_time_s for run in runs)) for runs in zip(*pairs, strict=True)]
    return {
        name: {
            "median": median([first / second for first, second in common(one, three)]),
            "geometric_mean": paired_ratio(one, three),
        }
        for name, (one, three) in (("cpu", cpu_s), ("steps_per_second", speed_hz))
    }


def in_one_process(scenario: str, seed: int) -> Measured:
    """One whole program with the mission in it."""
    before = _cpu_of_children_s()
    argv = [sys.executable, "-c", IN_ONE, scenario, str(seed)]
    environment = child_environment(os.environ)
    done = subprocess.run(argv, env=environment, check=True, capture_output=True, text=True)
    return Measured(cpu_s=_cpu_of_children_s() - before, **json.loads(done.stdout))


def in_three(scenario: str, seed: int) -> Measured:
    """`legpush run` with its three processes."""
    with tempfile.TemporaryDirectory(prefix="legpush-one-process-") as folder:
        before = _cpu_of_children_s()
        argv = ["legpush", "run", scenario, "--seed", str(seed)]
        argv += ["--no-video", "--no-picture", "--out", folder]
        subprocess.run([Path(sys.executable).with_name(argv[0]), *argv[1:]], check=True, capture_output=True)
        cpu_s = _cpu_of_children_s() - before
        report = json.loads((Path(folder) / "report.json").read_bytes())
    return Measured(cpu_s=cpu_s, wall_time_s=report["wall_time_s"], state_crc=report["state_crc"])


def _cpu_of_children_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main(tyro.cli(Config))
