"""`python -m experiments.random_rooms`: runs whole missions in random rooms, with start, box and goal pose anywhere.

Each seed gives a room with obstacles, start, box and goal pose (`legpush scenarios random`), a mass of 0.1, 0.5 or
0.9 kg, a friction from 0.3 to 0.8, and one `legpush run` in three processes. A row per mission goes to
`results/random_rooms.csv`, tracks to `results/random_rooms_tracks.csv.gz`, the summary to `results/random_rooms.json`,
a mosaic of all rooms to `results/random_rooms.png`, and pictures of failed missions to `results/random_rooms_failed/`.
Missions in the table are not run again.
"""

import json
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any, Final

import tyro
from rich.progress import Progress

from agent_proc.statistics.intervals import mean, median, share
from experiments.evaluations import RESULTS, read_table, write_table
from experiments.plots.random_rooms import draw
from experiments.room_missions import drawn_room, run_mission
from legpush.scene.scenario import MissionSettings

TABLE: Final = RESULTS / "random_rooms.csv"
TRACKS: Final = RESULTS / "random_rooms_tracks.csv.gz"
FAILED: Final = RESULTS / "random_rooms_failed"
MEASURES: Final = (
    "box_position_error_m",
    "box_angle_error_deg",
    "box_path_rms_m",
    "n_push_cycles",
    "sim_time_s",
    "box_travel_m",
    "robot_travel_m",
)


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which rooms to use."""

    first_seed: int = 63_000
    n_rooms: int = 102
    jobs: int = 2
    """How many missions to run at once."""


def main(config: Config) -> int:
    """Run the missing missions, write the tables and draw."""
    rows: dict[int, dict[str, Any]] = {int(row["seed"]): dict(row) for row in read_table(TABLE)}
    tracks: list[dict[str, Any]] = [dict(row) for row in read_table(TRACKS)]
    seeds = range(config.first_seed, config.first_seed + config.n_rooms)
    missing = [seed for seed in seeds if seed not in rows]
    with Progress() as bar, ThreadPoolExecutor(config.jobs) as pool:
        task = bar.add_task("rooms", total=len(missing))
        one = partial(run_mission, handover_distance_m=MissionSettings().handover_distance_m, failed=FAILED)
        for row, track in pool.map(one, missing):
            rows[int(row["seed"])] = row
            tracks += track
            write_table([rows[seed] for seed in sorted(rows)], TABLE)
            write_table(tracks, TRACKS)
            bar.advance(task)
    here = [rows[seed] for seed in seeds]
    summary = summarize(here)
    (RESULTS / "random_rooms.json").write_text(json.dumps(summary, indent=1) + "\n")
    print(json.dumps(summary, indent=1))
    draw(here, [drawn_room(seed)[0] for seed in seeds], tracks)
    return 0


def summarize(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Summarize missions: share of success and errors with their intervals, and the reasons of failures."""
    n = len(rows)
    good = [row for row in rows if _is_true(row["success"])]
    summary: dict[str, Any] = {
        "n": n,
        "success_rate": asdict(share(len(good), n).rounded(4)),
        "rooms_drawn_anew": sum(int(row["n_unsolvable"]) for row in rows),
        "falls": sum(row["reason"] == "fell" for row in rows),
        "causes": dict(Counter(row["reason"] for row in rows if not _is_true(row["success"]))),
    }
    for name in MEASURES:
        values = [float(row[name]) for row in good]
        summary[name] = {
            "median": asdict(median(values).rounded(5)),
            "mean": asdict(mean(values).rounded(5)),
            "worst": round(max(values), 5),
        }
    summary["min_support_margin_m"] = min(float(row["min_support_margin_m"]) for row in rows)
    return summary


def _is_true(value: Any) -> bool:
    return str(value) == "True"


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
