"""`python -m experiments.references`: pushes boxes along a sine and along a closed Dubins path (Figs. 20, 21).

Each seed is one `legpush run` in three processes that closes the loop on the measured box, and one in an open loop as
in the paper. A row per mission goes to `results/references.csv`, the box after each push to
`results/references_tracks.csv.gz`, and the picture to `results/references.png`. Missions in the table are not run
again.
"""

import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product
from typing import Any, Final, Literal

import numpy as np
import tyro
from matplotlib.figure import Figure
from msgspec.structs import replace
from rich.progress import Progress

from agent_proc.statistics.intervals import mean, share
from experiments.evaluations import RESULTS, read_table, write_table
from experiments.mission_runs import run_scenario
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push
from legpush.scenarios.file import load_scenario
from legpush.scene.reference import reference_curve

TABLE: Final = RESULTS / "references.csv"
TRACKS: Final = RESULTS / "references_tracks.csv.gz"
SCENARIOS: Final = ("sine", "dubins_loop")
COMPOSITIONS: Final[tuple[Literal["closed_loop", "open_loop"], ...]] = ("closed_loop", "open_loop")
FROM_REPORT: Final = (
    "success",
    "reason",
    "box_position_error_m",
    "box_angle_error_deg",
    "box_path_rms_m",
    "trunk_max_abs_pitch_deg",
    "trunk_max_abs_roll_deg",
    "min_support_margin_m",
    "n_push_cycles",
    "sim_time_s",
    "state_crc",
)
COLORS: Final = {"closed_loop": "#3a6ea5", "open_loop": "#c8553d"}
Key = tuple[str, str, int]


@dataclass(frozen=True, kw_only=True)
class Config:
    """How many missions to run."""

    first_seed: int = 70_000
    n_seeds: int = 10
    jobs: int = 2
    """How many missions to run at once."""


def main(config: Config) -> int:
    """Run the missing missions, write the tables and draw."""
    rows: dict[Key, dict[str, Any]] = {_key(row): dict(row) for row in read_table(TABLE)}
    tracks = [dict(row) for row in read_table(TRACKS)]
    seeds = range(config.first_seed, config.first_seed + config.n_seeds)
    missing = [key for key in product(SCENARIOS, COMPOSITIONS, seeds) if key not in rows]
    with Progress() as bar, ThreadPoolExecutor(config.jobs) as pool:
        task = bar.add_task("missions", total=len(missing))
        for row, track in pool.map(_mission, missing):
            rows[_key(row)] = row
            tracks += track
            write_table([rows[key] for key in sorted(rows)], TABLE)
            write_table(tracks, TRACKS)
            bar.advance(task)
    for scenario, composition in product(SCENARIOS, COMPOSITIONS):
        some = [rows[scenario, composition, seed] for seed in seeds]
        success = share(sum(str(row["success"]) == "True" for row in some), len(some))
        print(f"{scenario}, {composition}: success {success.text('.0%')}")
        for name in ("box_path_rms_m", "box_position_error_m", "box_angle_error_deg"):
            values = [float(row[name]) for row in some]
            print(f"  {name}: {mean(values).text('.4f')}, worst {max(values):.4f}")
    draw(tracks)
    return 0


def _key(row: dict[str, Any]) -> Key:
    return str(row["scenario"]), str(row["composition"]), int(row["seed"])


def _mission(key: Key) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Run one mission; return its row and its track."""
    name, composition, seed = key
    scenario = load_scenario(name)
    pushing = replace(scenario.pushing, composition="open_loop" if composition == "open_loop" else "closed_loop")
    report, record = run_scenario(replace(scenario, pushing=pushing), seed)
    of = {"scenario": name, "composition": composition, "seed": seed}
    boxes = [planar_pose(step.world.box) for step in record.steps if isinstance(step.motion, Push)]
    track = [{**of, "x_m": round(box.x_m, 4), "y_m": round(box.y_m, 4)} for box in boxes]
    return of | {field: report[field] for field in FROM_REPORT}, track


def draw(tracks: Iterable[dict[str, Any]]) -> None:
    """Draw the reference and the tracks of the boxes, a panel for each curve."""
    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    by_key: dict[Key, list[tuple[float, float]]] = {}
    for point in tracks:
        by_key.setdefault(_key(point), []).append((float(point["x_m"]), float(point["y_m"])))
    for axis, name in zip(figure.subplots(1, 2, width_ratios=[1.35, 1.0]), SCENARIOS, strict=True):
        scenario = load_scenario(name)
        if scenario.reference is None:
            raise RuntimeError(f"Expected a reference in the scenario {name}")
        told: set[str] = set()
        for composition in reversed(COMPOSITIONS):
            for key, points in by_key.items():
                if key[:2] == (name, composition):
                    label = None if composition in told else f"box, {composition.replace('_', ' ')}"
                    axis.plot(*np.array(points).T, color=COLORS[composition], lw=0.9, alpha=0.7, label=label)
                    told.add(composition)
        curve = reference_curve(scenario.reference, scenario.box.pose.pose())
        axis.plot(*curve[:, :2].T, "k--", lw=1.3, label="reference")
        axis.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title=f"scenario {name}")
        axis.legend(fontsize=8, frameon=False, loc="upper right")
    figure.savefig(RESULTS / "references.png", dpi=120)


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
