"""`python -m benchmarks.numerics_cost`: CPU seconds of whole missions under the numerics profile, over native ones.

Pairs of one mission each, in one process, in turn with the order reversed from pair to pair; CPU seconds are those of
the mission alone, without the start of the interpreter. Native missions compute other bits and may take other pushes,
so seconds are divided by simulated seconds.
"""

import json
import os
import platform
import shlex
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from agent_proc.statistics import mean_interval
from legpush.numerics.profile import VARIABLE, X86_64_V3, with_profile
from legpush.processes.environment import ONE_THREAD
from legpush.versions import installed_versions

MISSION = """
import json, sys, time, legpush
from legpush.numerics.current import current
scenario, seed = sys.argv[1], int(sys.argv[2])
legpush.run(scenario, seed=seed)
began = time.process_time()
run = legpush.run(scenario, seed=seed)
cpu_s = time.process_time() - began
print(json.dumps({"numerics": current().name, "cpu_s": cpu_s, "sim_s": run.report.sim_time_s, "crc": run.state_crc}))
"""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    scenario: str = "default"
    """The mission."""
    n_pairs: int = 8
    """Pairs, each with a seed of its own, from 0."""
    out: Annotated[Path, tyro.conf.arg(metavar="JSON")] = Path("benchmarks/results/numerics_cost.json")
    """Where the numbers go."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One mission."""

    numerics: str
    cpu_s: float
    sim_s: float
    crc: str

    @property
    def cost(self) -> float:
        """CPU seconds per simulated second."""
        return self.cpu_s / self.sim_s


def main(config: Config) -> None:
    """Measure, print, and write the numbers."""
    ours = (VARIABLE, "OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES")
    plain = {**{name: value for name, value in os.environ.items() if name not in ours}, **ONE_THREAD}
    environments = {X86_64_V3: with_profile(plain), "native": {**plain, VARIABLE: "native"}}
    pairs: list[dict[str, Measured]] = []
    for seed in range(config.n_pairs):
        order = list(environments) if seed % 2 else list(reversed(environments))
        pairs.append({name: _mission(config.scenario, seed, environments[name]) for name in order})
        costs = ", ".join(f"{name} {pairs[-1][name].cost:.4f}" for name in environments)
        print(f"seed {seed}: CPU seconds per simulated second: {costs}", flush=True)
    ratios = [pair[X86_64_V3].cost / pair["native"].cost for pair in pairs]
    estimate = mean_interval(ratios)
    print(
        f"CPU under the profile over native: median {np.median(ratios):.3f}, mean {estimate.value:.3f} "
        f"[{estimate.low:.3f}, {estimate.high:.3f}] (95 %, bootstrap), n {len(ratios)}"
    )
    result = {
        "command": shlex.join(["python", "-m", "benchmarks.numerics_cost", *sys.argv[1:]]),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores",
        "versions": installed_versions(),
        "ratios": ratios,
        "pairs": [
            {"seed": seed, **{name: asdict(one) for name, one in pair.items()}} for seed, pair in enumerate(pairs)
        ],
    }
    config.out.write_text(json.dumps(result, indent=1) + "\n")


def _mission(scenario: str, seed: int, environment: dict[str, str]) -> Measured:
    """Run a mission twice in a process of its own, and measure the second."""
    argv = [sys.executable, "-P", "-c", MISSION, scenario, str(seed)]
    done = subprocess.run(argv, env=environment, check=True, capture_output=True, text=True)
    return Measured(**json.loads(done.stdout))


if __name__ == "__main__":
    main(tyro.cli(Config))
