"""`python experiments/missions.py`: runs whole missions with many seeds, each in three processes.

Each seed is one `legpush run`. A row per mission goes to `results/missions_<scenario>_<policy>.csv`, and the summary
(share of success, mean of each measure, both with 95 % intervals and their kinds, worst values) to a JSON file beside
it.
"""

import csv
import json
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import tyro
from rich.progress import track

from agent_proc.statistics.intervals import mean, share

RESULTS: Final = Path(__file__).parent / "results"
MEASURES: Final = (
    "box_position_error_m",
    "box_angle_error_deg",
    "walk_tracking_rms_m",
    "trunk_max_abs_pitch_deg",
    "trunk_max_abs_roll_deg",
    "min_support_margin_m",
    "n_push_cycles",
    "n_footsteps",
    "sim_time_s",
    "real_time_factor",
)
COLUMNS: Final = ("seed", "success", "reason", "handover_distance_m", *MEASURES, "state_crc")
WORST: Final = {"min_support_margin_m": np.min, "real_time_factor": np.min}
"""The worst value is the largest one, except for these measures."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which missions to run."""

    scenario: str = "default"
    """A built-in scenario or a scenario file."""
    policy: str = "variable"
    """The policy, as for `legpush run`."""
    first_seed: int = 500
    n_seeds: int = 20
    """Number of seeds; nothing was tuned on the default ones."""
    keep: bool = False
    """Run only the seeds that have no row yet, for example after an interruption."""


def main(config: Config) -> int:
    """Run the missing missions and summarize all; returns 1 if a mission failed."""
    RESULTS.mkdir(exist_ok=True)
    table = RESULTS / f"missions_{Path(config.scenario).stem}_{Path(config.policy).name}.csv"
    rows = _read(table) if config.keep else {}
    seeds = range(config.first_seed, config.first_seed + config.n_seeds)
    missing = [seed for seed in seeds if seed not in rows]
    for seed in track(missing, description=f"{config.scenario}: missions", disable=not missing):
        rows[seed] = _mission(config, seed)
        _write(table, rows)
    summary = summarize([rows[seed] for seed in seeds])
    table.with_suffix(".json").write_text(json.dumps(summary, indent=2) + "\n")
    print(json.dumps(summary, indent=2))
    return 0 if summary["successes"] == summary["n"] else 1


def _mission(config: Config, seed: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="legpush-missions-") as scratch:
        out = Path(scratch) / f"seed-{seed}"
        command = [str(Path(sys.executable).with_name("legpush")), "run", "--scenario", config.scenario]
        command += ["--policy", config.policy, "--seed", str(seed), "--out", str(out), "--no-video"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            raise SystemExit(f"seed {seed}: legpush run exited with {done.returncode}: {done.stderr.strip()}")
        report = json.loads((out / "report.json").read_text())
    return {column: report[column] for column in COLUMNS}


def summarize(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return counts, the share of success, and the mean and the worst value of each measure."""
    n_good = sum(str(row["success"]) == "True" for row in rows)
    summary: dict[str, Any] = {
        "n": len(rows),
        "seeds": [int(row["seed"]) for row in rows],
        "successes": n_good,
        "success_rate": asdict(share(n_good, len(rows)).rounded(4)),
        "falls": sum(row["reason"] == "fell" for row in rows),
    }
    for name in MEASURES:
        values = [float(row[name]) for row in rows if row[name] not in (None, "")]
        if values:
            worst = round(float(WORST.get(name, np.max)(values)), 5)
            summary[name] = {"mean": asdict(mean(values).rounded(5)), "worst": worst}
    return summary


def _read(table: Path) -> dict[int, dict[str, Any]]:
    if not table.exists():
        return {}
    with table.open(newline="") as file:
        return {int(row["seed"]): row for row in csv.DictReader(file)}


def _write(table: Path, rows: dict[int, dict[str, Any]]) -> None:
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows[seed] for seed in sorted(rows))


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
