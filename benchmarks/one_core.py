"""`python -m benchmarks.one_core`: speed of whole missions in three processes that share one core, over real time.

The numbers go to `results/one_core.json`.
"""

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro

from benchmarks.report import write_report


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which mission to run, and how often."""

    scenario: str = "default"
    """A built-in scenario or a scenario file."""
    missions: int = 5
    """Number of missions; their seeds count from 0."""


def main(config: Config) -> None:
    """Pin this process and its children to one core, run the missions, and report their speed."""
    core = min(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    factors, simulated = [], []
    for seed in range(config.missions):
        with tempfile.TemporaryDirectory(prefix="legpush-one-core-") as scratch:
            out = Path(scratch) / "run"
            legpush = str(Path(sys.executable).with_name("legpush"))
            command = [legpush, "run", config.scenario, "--seed", str(seed)]
            subprocess.run([*command, "--out", str(out), "--no-video"], check=True, capture_output=True)
            report = json.loads((out / "report.json").read_text())
        factors.append(report["real_time_factor"])
        simulated.append(report["sim_time_s"])
    write_report(
        "one_core",
        {
            "scenario": config.scenario,
            "n": len(factors),
            "simulated_s": round(float(np.mean(simulated)), 1),
            "median_times_real_time": round(float(np.median(factors)), 2),
            "least_times_real_time": round(min(factors), 2),
        },
    )


if __name__ == "__main__":
    main(tyro.cli(Config))
