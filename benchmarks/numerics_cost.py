"""`python -m benchmarks.numerics_cost`: CPU seconds of whole missions under the numerics profile, over native ones.

Two processes, one under the profile and one without, do the same mission in turn, in an order that changes from pair to
pair. CPU seconds are those of the mission alone, after a first one. Native missions compute other bits and may take
other pushes, so seconds are divided by simulated seconds.
"""

import json
import os
import subprocess
import sys
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from types import TracebackType
from typing import Any, Self

import tyro

from agent_proc.statistics.intervals import median
from agent_proc.statistics.paired import paired_ratio
from benchmarks.report import write_report
from legpush.numerics.profile import VARIABLE, X86_64_V3, with_profile
from legpush.processes.environment import ONE_THREAD

WORKER = """
import json, sys, time, legpush
from legpush.numerics.current import current
scenario = sys.argv[1]
legpush.run(scenario, seed=0)
print(json.dumps({"numerics": current().name}), flush=True)
for line in sys.stdin:
    began = time.process_time()
    run = legpush.run(scenario, seed=int(line))
    cpu_s = time.process_time() - began
    print(json.dumps({"cpu_s": cpu_s, "sim_s": run.report.sim_time_s, "state_crc": run.state_crc}), flush=True)
"""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    scenario: str = "push"
    """The mission."""
    n_pairs: int = 12
    """Pairs, each with a seed of its own, from 0."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One mission."""

    cpu_s: float
    sim_s: float
    state_crc: str

    @property
    def cost(self) -> float:
        """CPU seconds per simulated second."""
        return self.cpu_s / self.sim_s


class Worker:
    """A process that carries out missions when it is asked to; a context manager."""

    def __init__(self, scenario: str, environment: dict[str, str]) -> None:
        """Start it, and wait for its first mission."""
        argv = [sys.executable, "-P", "-c", WORKER, scenario]
        self._process = subprocess.Popen(
            argv, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self.numerics: str = self._answer()["numerics"]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._process.communicate()

    def mission(self, seed: int) -> Measured:
        """Carry out the mission with this seed."""
        if self._process.stdin is None:
            raise RuntimeError("The process has no standard input")
        self._process.stdin.write(f"{seed}\n")
        self._process.stdin.flush()
        return Measured(**self._answer())

    def _answer(self) -> dict[str, Any]:
        line = self._process.stdout.readline() if self._process.stdout is not None else ""
        answer: dict[str, Any] = json.loads(line)
        return answer


def main(config: Config) -> None:
    """Measure, print, and write the numbers."""
    ours = (VARIABLE, "OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES")
    plain = {**{name: value for name, value in os.environ.items() if name not in ours}, **ONE_THREAD}
    environments = {X86_64_V3: with_profile(plain), "native": {**plain, VARIABLE: "native"}}
    pairs: list[dict[str, Measured]] = []
    with ExitStack() as stack:
        workers = {name: stack.enter_context(Worker(config.scenario, env)) for name, env in environments.items()}
        for seed in range(config.n_pairs):
            order = list(workers) if seed % 2 else list(reversed(workers))
            pairs.append({name: workers[name].mission(seed) for name in order})
            costs = ", ".join(f"{name} {pairs[-1][name].cost:.4f}" for name in workers)
            print(f"seed {seed}: CPU seconds per simulated second: {costs}", flush=True)
    costs_by_name = {name: {seed: pair[name].cost for seed, pair in enumerate(pairs)} for name in environments}
    ratios = [pair[X86_64_V3].cost / pair["native"].cost for pair in pairs]
    numbers = {
        "numerics": {name: worker.numerics for name, worker in workers.items()},
        "cpu_ratio": {
            "median": asdict(median(ratios)),
            "geometric_mean": asdict(paired_ratio(costs_by_name[X86_64_V3], costs_by_name["native"])),
        },
        "pairs": [
            {"seed": seed, **{name: asdict(one) for name, one in pair.items()}} for seed, pair in enumerate(pairs)
        ],
    }
    write_report("numerics_cost", numbers)


if __name__ == "__main__":
    main(tyro.cli(Config))
