"""Whole missions with many seeds: the share of success, and the mean and the worst value of each measure."""

from typing import Any, Final

import numpy as np

from agent_proc.statistics.intervals import mean, share
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain

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
    *(
        f"{phase}_{name}"
        for phase in ("walk", "push")
        for name in (
            "hip_x_usual_torque_n_m",
            "hip_y_usual_torque_n_m",
            "knee_usual_torque_n_m",
            "touchdowns_per_footstep",
            "usual_landing_speed_m_s",
            "max_penetration_m",
            "n_outside_support",
            "min_support_margin_m",
            "n_unexpected_steps",
            "cost_of_transport",
        )
    ),
)
WORST: Final = {name: np.min for name in MEASURES if name.endswith("min_support_margin_m")}
"""The worst value is the largest one, except for these measures."""
STUDIES: Final = ("missions", "shipped")
COLUMNS: Final = ("scenario", "seed", "success", "reason", "handover_distance_m", *MEASURES, "state_crc")


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    files = {}
    for name in STUDIES:
        study = read_rows(name)
        by_scenario = dict.fromkeys(row["scenario"] for row in study.rows)
        scenarios = {scenario: summarize(study.where(scenario=scenario)) for scenario in by_scenario}
        table = [{column: row[column] for column in COLUMNS} for row in study.rows]
        files[f"{name}.csv"] = as_csv(table)
        numbers = {"all": summarize(study.rows), "scenarios": scenarios}
        files[f"{name}.json"] = as_json(made_of(**{name: study}), numbers)
    return files


def summarize(rows: list[Row]) -> Row:
    """Return counts, the share of success, and the mean and the worst value of each measure."""
    n_good, n = sum(row["success"] for row in rows), len(rows)
    summary: dict[str, Any] = {
        "n": n,
        "first_seed": min(row["seed"] for row in rows),
        "last_seed": max(row["seed"] for row in rows),
        "successes": n_good,
        "success_rate": plain(share(n_good, n), 4),
        "falls": sum(row["reason"] == "fell" for row in rows),
    }
    for name in MEASURES:
        values = [row[name] for row in rows if row[name] is not None]
        if values:
            summary[name] = {"mean": plain(mean(values), 7), "worst": round(float(WORST.get(name, np.max)(values)), 5)}
    return summary
