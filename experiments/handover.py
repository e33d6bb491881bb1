"""`python -m experiments.handover`: runs missions in the same random rooms with different hand-over distances.

The paper leaves open at which distance the robot should stop following the map and use the measured box instead. The
rooms are the first ones of `python -m experiments.random_rooms`, whose own missions hand over at 3 m. A row per mission
goes to `results/handover.csv`, the differences from 3 m in the same rooms to `results/handover_differences.csv`, the
picture to `results/handover.png`. Missions in the table are not run again.
"""

import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product
from typing import Any, Final

import numpy as np
import tyro
from matplotlib.figure import Figure
from rich.progress import Progress

from agent_proc.statistics.estimate import Estimate, kinds_in_words
from agent_proc.statistics.intervals import mean, share
from agent_proc.statistics.paired import paired_difference
from experiments.evaluations import RESULTS, read_table, write_table
from experiments.room_missions import run_mission
from legpush.scene.scenario import MissionSettings

TABLE: Final = RESULTS / "handover.csv"
DISTANCES_M: Final = (0.5, 1.0, 2.0, 3.0, 4.5, 6.0)
MEASURES: Final = (
    ("box_position_error_m", "box position error [cm]", 100.0),
    ("box_angle_error_deg", "box angle error [deg]", 1.0),
    ("robot_travel_m", "way of the robot [m]", 1.0),
    ("sim_time_s", "simulated time [s]", 1.0),
)
USUAL_M: Final = MissionSettings().handover_distance_m
BLUE: Final = "#3a6ea5"


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which rooms to use."""

    first_seed: int = 63_000
    n_rooms: int = 24
    jobs: int = 2
    """How many missions to run at once."""


def main(config: Config) -> int:
    """Run the missing missions, write the table and draw."""
    rows = {(float(row["handover_m"]), int(row["seed"])): dict(row) for row in read_table(TABLE)}
    seeds = range(config.first_seed, config.first_seed + config.n_rooms)
    missing = [key for key in product(DISTANCES_M, seeds) if key not in rows]
    with Progress() as bar, ThreadPoolExecutor(config.jobs) as pool:
        task = bar.add_task("missions", total=len(missing))
        for key, row in zip(missing, pool.map(_row, missing), strict=True):
            rows[key] = row
            write_table([rows[each] for each in sorted(rows)], TABLE)
            bar.advance(task)
    here = {distance_m: [rows[distance_m, seed] for seed in seeds] for distance_m in DISTANCES_M}
    for distance_m, some in here.items():
        success = share(sum(str(row["success"]) == "True" for row in some), len(some))
        print(f"{distance_m} m: success {success.text('.0%')}")
        for name, label, scale in MEASURES:
            print(f"  {label}: {_mean(some, name).scaled(scale).text('.2f')}")
    differences = [difference_row(distance_m, here) for distance_m in DISTANCES_M if distance_m != USUAL_M]
    write_table(differences, RESULTS / "handover_differences.csv")
    draw(here)
    return 0


def _row(key: tuple[float, int]) -> dict[str, Any]:
    distance_m, seed = key
    row, _ = run_mission(seed, distance_m)
    return {"handover_m": distance_m, **row}


def difference_row(distance_m: float, here: dict[float, list[dict[str, Any]]]) -> dict[str, Any]:
    """Return by how much each measure differs from that at the usual distance, in the same rooms."""
    row: dict[str, Any] = {"handover_m": distance_m, "minus_that_at_m": USUAL_M}
    for name, _, _ in MEASURES:
        some, usual = (_by_seed(here[each], name) for each in (distance_m, USUAL_M))
        row |= paired_difference(some, usual).columns(name, 5)
    return row


def _mean(rows: list[dict[str, Any]], name: str) -> Estimate:
    return mean(list(_by_seed(rows, name).values()))


def _by_seed(rows: list[dict[str, Any]], name: str) -> dict[int, float]:
    """Return a measure of the successful missions by their seeds."""
    return {int(row["seed"]): float(row[name]) for row in rows if str(row["success"]) == "True"}


def draw(here: dict[float, list[dict[str, Any]]]) -> None:
    """Draw each measure over the distance: missions as dots, means with intervals."""
    figure = Figure(figsize=(10.0, 5.6), layout="constrained")
    kinds: list[str] = []
    for axis, (name, label, scale) in zip(figure.subplots(2, 2).ravel(), MEASURES, strict=True):
        jitter = np.random.default_rng(0)
        for distance_m, rows in here.items():
            values = [scale * value for value in _by_seed(rows, name).values()]
            at = distance_m + jitter.uniform(-0.1, 0.1, len(values))
            axis.plot(at, values, "o", ms=3, color=BLUE, alpha=0.3, mew=0)
        means = [_mean(rows, name).scaled(scale) for rows in here.values()]
        kinds += [one.kind for one in means]
        middle, ends = np.array([one.value for one in means]), np.array([one.ends for one in means]).T
        axis.errorbar(list(here), middle, np.abs(ends - middle), fmt="o-", color=BLUE, capsize=3, ms=4)
        axis.set(xlabel="distance to the box at hand-over, at most [m]", ylabel=label)
        axis.set_ylim(bottom=0.0)
    n = len(next(iter(here.values())))
    figure.suptitle(f"Hand-over distance, the same {n} random rooms: missions, and means with {kinds_in_words(kinds)}")
    figure.savefig(RESULTS / "handover.png", dpi=110)


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
