"""Whole missions in random rooms: a summary, and a mosaic of every room with the tracks of robot and box."""

from collections import Counter
from math import ceil
from typing import Any, Final

import msgspec
import numpy as np

from agent_proc.figures import Axes, Figure, Polygon
from agent_proc.statistics.intervals import mean, median, share
from experiments.rows import Row, has_rows, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain
from legpush.scene.footprints import box_footprint, obstacle_footprint
from legpush.scene.scenario import Scenario

MEASURES: Final = (
    "box_position_error_m",
    "box_angle_error_deg",
    "box_path_rms_m",
    "n_push_cycles",
    "sim_time_s",
    "box_travel_m",
    "robot_travel_m",
)
STUDIES: Final = ("random_rooms", "unseen_rooms")
PAIRED: Final = "random_rooms_real"
"""The study of the same rooms in an ideal world and in a real one."""
PROFILE: Final = "realism.profile"
N_COLUMNS: Final = 12
GOOD, BAD = "#2b8a4b", "#c0392b"


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    files = {}
    for name in STUDIES:
        study = read_rows(name)
        files[f"{name}.csv"] = _csv(study.rows)
        files[f"{name}.json"] = as_json(made_of(**{name: study}), summarize(study.rows))
    if has_rows(PAIRED):
        study = read_rows(PAIRED)
        files[f"{PAIRED}.csv"] = _csv(study.rows)
        files[f"{PAIRED}.json"] = as_json(made_of(**{PAIRED: study}), compare(study.rows))
    return files


def _csv(rows: list[Row]) -> str:
    return as_csv(
        [
            {key: value for key, value in row.items() if not isinstance(value, list) and key != "drawn_scenario"}
            for row in rows
        ]
    )


def compare(rows: list[Row]) -> Row:
    """Summarize missions of each profile, and count the rooms in which they ended differently."""
    profiles = {each: [row for row in rows if row[PROFILE] == each] for each in ("ideal", "real")}
    succeeded = {name: {row["seed"] for row in of if row["success"]} for name, of in profiles.items()}
    return {
        "profiles": {name: summarize(of) for name, of in profiles.items()},
        "n_only_ideal": len(succeeded["ideal"] - succeeded["real"]),
        "n_only_real": len(succeeded["real"] - succeeded["ideal"]),
    }


def summarize(rows: list[Row]) -> Row:
    """Summarize missions: share of success and errors with their intervals, and the reasons of failures."""
    n = len(rows)
    good = [row for row in rows if row["success"]]
    summary: dict[str, Any] = {
        "n": n,
        "successes": len(good),
        "success_rate": plain(share(len(good), n), 4),
        "rejected_rooms": sum(row["n_unsolvable"] for row in rows),
        "falls": sum(row["reason"] == "fell" for row in rows),
        "causes": dict(Counter(row["reason"] for row in rows if not row["success"])),
        "max_abs_pitch_deg": max(row["trunk_max_abs_pitch_deg"] for row in rows),
        "max_abs_roll_deg": max(row["trunk_max_abs_roll_deg"] for row in rows),
        "min_support_margin_m": min(row["min_support_margin_m"] for row in rows),
        "n_with_negative_margin": sum(row["min_support_margin_m"] < 0.0 for row in rows),
    }
    for phase in ("walk", "push"):
        if phase_rows := [row for row in rows if row.get(f"{phase}_n_steps")]:
            summary[phase] = {
                "n_steps": sum(row[f"{phase}_n_steps"] for row in phase_rows),
                "n_outside_support": sum(row[f"{phase}_n_outside_support"] for row in phase_rows),
                "n_missions_outside": sum(row[f"{phase}_n_outside_support"] > 0 for row in phase_rows),
                "min_support_margin_m": min(row[f"{phase}_min_support_margin_m"] for row in phase_rows),
                "n_unexpected_steps": sum(row[f"{phase}_n_unexpected_steps"] for row in phase_rows),
                "n_missions_unexpected": sum(row[f"{phase}_n_unexpected_steps"] > 0 for row in phase_rows),
            }
    for name in MEASURES:
        values = [row[name] for row in good]
        summary[name] = {
            "median": plain(median(values), 7),
            "mean": plain(mean(values), 7),
            "worst": round(max(values), 5),
        }
    return summary


def pictures() -> dict[str, Figure]:
    """Draw all rooms; the frame is green if the mission succeeded, else red."""
    figures = {f"{name}.png": _mosaic(read_rows(name).rows) for name in STUDIES}
    if has_rows(PAIRED):
        figures[f"{PAIRED}.png"] = _mosaic(read_rows(PAIRED).where(**{PROFILE: "real"}))
    return figures


def _mosaic(rows: list[Row]) -> Figure:
    n_rows = ceil(len(rows) / N_COLUMNS)
    figure = Figure(figsize=(1.35 * N_COLUMNS, 1.55 * n_rows), layout="constrained", dpi=90)
    cells = np.atleast_1d(figure.subplots(n_rows, N_COLUMNS, squeeze=False)).ravel()
    for axis in cells:
        axis.set_axis_off()
    for axis, row in zip(cells, rows, strict=False):
        _draw_room(axis, row, msgspec.json.decode(row["drawn_scenario"], type=Scenario))
    figure.suptitle(
        "Random rooms: the box (brown) from dashed to green, the robot's way (blue); red frames: no success"
    )
    return figure


def _draw_room(axis: Axes, row: Row, scenario: Scenario) -> None:
    good = row["success"]
    axis.set_axis_on()
    axis.set(xticks=[], yticks=[], aspect="equal", xlim=(0, scenario.room.size_m[0]), ylim=(0, scenario.room.size_m[1]))
    for spine in axis.spines.values():
        spine.set_color(GOOD if good else BAD)
        spine.set_linewidth(1.0 if good else 2.5)
    for obstacle in scenario.room.obstacles:
        axis.add_patch(Polygon(obstacle_footprint(obstacle).corners(), color="#3b3f45"))
    for pose, color, style in ((scenario.box.pose, "#8d6748", "--"), (scenario.goal.pose, GOOD, "-")):
        corners = box_footprint(scenario.box, pose.pose()).corners()
        axis.add_patch(Polygon(corners, fill=False, color=color, linestyle=style, linewidth=1.0))
    for body, color in (("trunk", "#3a6ea5"), ("box", "#8d6748")):
        points = row[f"track_{body}_x_m"], row[f"track_{body}_y_m"]
        axis.plot(*points, color=color, linewidth=0.7 if body == "trunk" else 1.3)
    label = "" if good else f" {row['reason']}"
    axis.set_title(f"{row['seed']}{label}", fontsize=8, pad=2)
