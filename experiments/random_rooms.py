"""`python -m experiments.random_rooms`: whole missions, anywhere to anywhere, in rooms that nobody has seen.

Each seed is a room with obstacles, start, box and goal pose (`legpush scenarios random`), a mass of 0.1, 0.5 or 0.9 kg
and a friction from 0.3 to 0.8, and one `legpush run` in three processes. A row per mission goes to
`results/random_rooms.csv`, tracks to `results/random_rooms_tracks.csv.gz`, the summary to `results/random_rooms.json`,
a mosaic of all rooms to `results/random_rooms.png`. What is in the table already is not run again.
"""

import json
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import tyro
from rich.progress import Progress

from agent_proc.record import MissionRecord, read_record
from agent_proc.statistics import mean_interval, wilson
from experiments.evaluations import RESULTS, read_table, write_table
from experiments.random_rooms_plot import draw
from legpush.episode import read_episode
from legpush.messages import BoxPathQuery, Push
from legpush.random_room import RandomRoom
from legpush.random_scenario import random_scenario
from legpush.scenario import Scenario
from legpush.scenario_file import write_scenario

TABLE: Final = RESULTS / "random_rooms.csv"
TRACKS: Final = RESULTS / "random_rooms_tracks.csv.gz"
MASSES_KG: Final = (0.1, 0.5, 0.9)
FRICTION: Final = (0.3, 0.8)
POSITION_TOLERANCE_M: Final = 0.05
ANGLE_TOLERANCE_DEG: Final = 5.0
FROM_REPORT: Final = (
    "success",
    "reason",
    "detail",
    "box_position_error_m",
    "box_angle_error_deg",
    "walk_tracking_rms_m",
    "handover_distance_m",
    "trunk_max_abs_pitch_deg",
    "trunk_max_abs_roll_deg",
    "min_support_margin_m",
    "n_push_cycles",
    "n_footsteps",
    "sim_time_s",
    "state_crc",
)
TRACK_STEPS: Final = 4
"""Every so many steps of a mission are in its track."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which rooms."""

    first_seed: int = 60_000
    n_rooms: int = 102
    jobs: int = 2
    """Missions at once."""


def main(config: Config) -> int:
    """Run what is missing, tabulate, draw."""
    rows: dict[int, dict[str, Any]] = {int(row["seed"]): dict(row) for row in read_table(TABLE)}
    tracks: list[dict[str, Any]] = [dict(row) for row in read_table(TRACKS)]
    seeds = range(config.first_seed, config.first_seed + config.n_rooms)
    missing = [seed for seed in seeds if seed not in rows]
    with Progress() as bar, ThreadPoolExecutor(config.jobs) as pool:
        task = bar.add_task("rooms", total=len(missing))
        for row, track in pool.map(_mission, missing):
            rows[int(row["seed"])] = row
            tracks += track
            write_table([rows[seed] for seed in sorted(rows)], TABLE)
            write_table(tracks, TRACKS)
            bar.advance(task)
    here = [rows[seed] for seed in seeds]
    summary = summarize(here)
    (RESULTS / "random_rooms.json").write_text(json.dumps(summary, indent=1) + "\n")
    print(json.dumps(summary, indent=1))
    draw(here, [scenario_of(seed) for seed in seeds], tracks)
    return 0


def scenario_of(seed: int) -> Scenario:
    """The room of a seed."""
    low, high = FRICTION
    room = RandomRoom(
        mass_kg=MASSES_KG[seed % len(MASSES_KG)],
        friction=round(low + (high - low) * float(np.random.default_rng(seed).random()), 2),
        position_tolerance_m=POSITION_TOLERANCE_M,
        angle_tolerance_deg=ANGLE_TOLERANCE_DEG,
    )
    return random_scenario(room, seed)


def _mission(seed: int) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """One mission: its row and its track."""
    scenario = scenario_of(seed)
    with tempfile.TemporaryDirectory(prefix="legpush-room-") as scratch:
        file, out = Path(scratch) / "room.toml", Path(scratch) / "run"
        write_scenario(scenario, file)
        command = [str(Path(sys.executable).with_name("legpush")), "run", "--scenario", str(file)]
        command += ["--seed", str(seed), "--out", str(out), "--no-video"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            raise SystemExit(f"seed {seed}: legpush run exited with {done.returncode}: {done.stderr.strip()}")
        report = json.loads((out / "report.json").read_text())
        record = read_record(read_episode(next(out.glob("episode-*.journal"))))
    row = {"seed": seed, "mass_kg": scenario.box.mass_kg, "friction": scenario.box.friction}
    row |= {name: report[name] for name in FROM_REPORT}
    return row | _of_record(record), _track(seed, record)


def _of_record(record: MissionRecord) -> dict[str, Any]:
    """What the report has not: how far box and robot went, and by which faces."""
    ticks = record.ticks()
    paths = [each for each in record.plans if isinstance(each.query, BoxPathQuery)]
    faces = [step.motion.face for step in record.steps if isinstance(step.motion, Push)]
    return {
        "n_box_paths": len(paths),
        "first_box_path_m": round(paths[0].plan.length_m, 3) if paths else None,
        "n_faces": len(set(faces)),
        "n_face_changes": sum(a != b for a, b in pairwise(faces)),
        "box_travel_m": round(_length_m(ticks.box[:, :2]), 3),
        "robot_travel_m": round(_length_m(ticks.trunk_m), 3),
    }


def _length_m(points: Any) -> float:
    every = points[:: 50 * TRACK_STEPS]
    return float(np.hypot(*np.diff(every, axis=0).T).sum())


def _track(seed: int, record: MissionRecord) -> list[dict[str, Any]]:
    steps = [*record.steps[::TRACK_STEPS], record.steps[-1]]
    return [
        {
            "seed": seed,
            "trunk_x_m": round(step.world.trunk.position_m[0], 2),
            "trunk_y_m": round(step.world.trunk.position_m[1], 2),
            "box_x_m": round(step.world.box.position_m[0], 2),
            "box_y_m": round(step.world.box.position_m[1], 2),
        }
        for step in steps
    ]


def summarize(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Share of success with its interval, errors, and what the others ended for."""
    n = len(rows)
    success = wilson(sum(_is_true(row["success"]) for row in rows), n)
    good = [row for row in rows if _is_true(row["success"])]
    summary: dict[str, Any] = {
        "n": n,
        "success_rate": round(success.value, 4),
        "success_rate_95": [round(success.low, 4), round(success.high, 4)],
        "falls": sum(row["reason"] == "fell" for row in rows),
        "causes": dict(Counter(row["reason"] for row in rows if not _is_true(row["success"]))),
    }
    for name in ("box_position_error_m", "box_angle_error_deg", "n_push_cycles", "sim_time_s", "box_travel_m"):
        values = [float(row[name]) for row in good]
        mean = mean_interval(values)
        summary[name] = {
            "median": round(float(np.median(values)), 5),
            "mean": round(mean.value, 5),
            "mean_95": [round(mean.low, 5), round(mean.high, 5)],
            "worst": round(max(values), 5),
        }
    summary["min_support_margin_m"] = min(float(row["min_support_margin_m"]) for row in rows)
    return summary


def _is_true(value: Any) -> bool:
    return str(value) == "True"


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
