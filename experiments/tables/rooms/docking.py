"""Missions with docking and with planned paths alone, seed by seed: goals near the box, and random rooms."""

from typing import Any, Final

import numpy as np

from agent_proc.statistics.intervals import mean, share
from agent_proc.statistics.paired import paired_difference
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain
from experiments.tables.rooms.by_seed import failures, of_successes

AXIS: Final = "pushing.docking_m"
MEASURES: Final = ("sim_time_s", "n_push_cycles", "box_position_error_m", "box_angle_error_deg")
COLUMNS: Final = ("seed", AXIS, "success", "reason", *MEASURES, "state_crc")
QUANTILES: Final = {"slow": 0.9, "slowest": 0.99}


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    return {**_texts("docking"), **_texts("docking_rooms")}


def _texts(name: str) -> dict[str, str]:
    study = read_rows(name)
    docked = [row for row in study.rows if row[AXIS] > 0.0]
    on_paths = [row for row in study.rows if row[AXIS] == 0.0]
    numbers = {
        "docked": _numbers(docked),
        "paths": _numbers(on_paths),
        "docked_minus_paths": {
            measure: plain(paired_difference(of_successes(docked, measure), of_successes(on_paths, measure)), 7)
            for measure in MEASURES
        },
    }
    return {
        f"{name}.csv": as_csv([{column: row[column] for column in COLUMNS} for row in study.rows]),
        f"{name}.json": as_json(made_of(**{name: study}), numbers),
    }


def _numbers(rows: list[Row]) -> dict[str, Any]:
    times_s = np.array([row["sim_time_s"] for row in rows])
    n_successes = sum(row["success"] for row in rows)
    return {
        "n": len(rows),
        "successes": n_successes,
        "success_rate": plain(share(n_successes, len(rows)), 4),
        "failures": failures(rows),
        "median_time_s": float(np.median(times_s)),
        **{f"{name}_time_s": round(float(np.quantile(times_s, quantile)), 1) for name, quantile in QUANTILES.items()},
        "largest_time_s": float(times_s.max()),
        **{name: plain(mean(list(of_successes(rows, name).values())), 7) for name in MEASURES},
        "largest_position_error_m": max(row["box_position_error_m"] for row in rows if row["success"]),
        "largest_angle_error_deg": max(row["box_angle_error_deg"] for row in rows if row["success"]),
    }
