"""Goals near the box, with docking and with planned paths alone: the same missions, seed by seed."""

from typing import Any, Final

import numpy as np

from agent_proc.statistics.intervals import mean, share
from agent_proc.statistics.paired import paired_difference
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain

AXIS: Final = "pushing.docking_m"
MEASURES: Final = ("sim_time_s", "n_push_cycles", "box_position_error_m", "box_angle_error_deg")
COLUMNS: Final = ("seed", AXIS, "success", "reason", *MEASURES, "state_crc")
QUANTILE: Final = 0.9


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows("docking")
    docked = [row for row in study.rows if row[AXIS] > 0.0]
    on_paths = [row for row in study.rows if row[AXIS] == 0.0]
    numbers = {
        "docked": _numbers(docked),
        "paths": _numbers(on_paths),
        "docked_minus_paths": {
            name: plain(paired_difference(_by_seed(docked, name), _by_seed(on_paths, name)), 7) for name in MEASURES
        },
    }
    return {
        "docking.csv": as_csv([{name: row[name] for name in COLUMNS} for row in study.rows]),
        "docking.json": as_json(made_of(docking=study), numbers),
    }


def _numbers(rows: list[Row]) -> dict[str, Any]:
    times_s = np.array([row["sim_time_s"] for row in rows])
    n_successes = sum(row["success"] for row in rows)
    return {
        "n": len(rows),
        "successes": n_successes,
        "success_rate": plain(share(n_successes, len(rows)), 4),
        "median_time_s": float(np.median(times_s)),
        "slow_time_s": round(float(np.quantile(times_s, QUANTILE)), 1),
        "largest_time_s": float(times_s.max()),
        **{name: plain(mean(list(_by_seed(rows, name).values())), 7) for name in MEASURES},
        "largest_position_error_m": max(row["box_position_error_m"] for row in rows if row["success"]),
    }


def _by_seed(rows: list[Row], name: str) -> dict[int, float]:
    """Return a measure of the successful missions by their seeds."""
    return {row["seed"]: float(row[name]) for row in rows if row["success"]}
