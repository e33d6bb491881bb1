"""`python -m benchmarks.interactions`: interactions per second in one process, and on the bus with 1 and 2 simulators.

An interaction is one push cycle, including the resets between episodes. All three settings take turns with the same
actions in the same episodes, so that other work on the machine affects them equally. The observations must be equal.
The numbers go to `results/interactions.json`.
"""

import tempfile
import threading
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro
from numpy.typing import NDArray

from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.simulators import own_simulators
from agent_proc.statistics.intervals import median
from agent_proc.statistics.paired import paired_ratio
from agent_proc.task.file import load_task
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.world import SteppingWorld
from sim_proc.simulator import Simulator


@dataclass(frozen=True, kw_only=True)
class Config:
    """Length of the measurement."""

    n_steps: int = 60
    """Push cycles of each simulator in a round."""
    n_rounds: int = 7
    """Number of rounds, each with all three settings in turn."""


def main(config: Config) -> None:
    """Measure all settings and report their rates."""
    with ExitStack() as stack:
        logs = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="legpush-interactions-")))
        bus_worlds = stack.enter_context(own_simulators(2, logs, threading.Event()))
        settings: dict[str, Sequence[SteppingWorld]] = {
            "in one process": [LocalWorld(Simulator())],
            "bus, 1 simulator": bus_worlds[:1],
            "bus, 2 simulators": bus_worlds,
        }
        rates: dict[str, list[float]] = {name: [] for name in settings}
        for round_seed in range(-1, config.n_rounds):  # The first one warms up.
            seen = {}
            for name, worlds in settings.items():
                rate, seen[name] = measure(worlds, abs(round_seed), config.n_steps)
                rates[name] += [rate] if round_seed >= 0 else []
            if not np.array_equal(seen["in one process"], seen["bus, 1 simulator"]):
                raise RuntimeError("The observations on the bus and in one process differ: the comparison is void")
    by_round = {name: dict(enumerate(values)) for name, values in rates.items()}
    one, bus_one, bus_two = (by_round[name] for name in rates)
    write_report(
        "interactions",
        {
            "n_rounds": config.n_rounds,
            "n_steps": config.n_steps,
            "per_second": {name: plain(median(values), 2) for name, values in rates.items()},
            "bus_over_one_process": plain(paired_ratio(bus_one, one), 4),
            "two_simulators_over_one": plain(paired_ratio(bus_two, bus_one), 4),
        },
    )


def measure(worlds: Sequence[SteppingWorld], seed: int, n_steps: int) -> tuple[float, NDArray[np.float32]]:
    """Return the interactions per second and the observations of the first simulator."""
    vec = PushVecEnv(load_task(), worlds, seed=seed)
    rng = np.random.default_rng(seed)
    vec.reset()
    observations = []
    began = time.perf_counter()
    for _ in range(n_steps):
        actions = rng.uniform(-1.0, 1.0, (1, 4)).repeat(len(worlds), axis=0).astype(np.float32)
        observations.append(np.asarray(vec.step(actions)[0])[0])
    rate = n_steps * len(worlds) / (time.perf_counter() - began)
    vec.close()
    return rate, np.array(observations)


if __name__ == "__main__":
    main(tyro.cli(Config))
