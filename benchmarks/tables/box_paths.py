"""Paths of the box in random rooms: time, and whether box and robot keep clear."""

from collections import Counter

import numpy as np

from agent_proc.statistics.intervals import median
from benchmarks.tables.rows import numbers, rows_of
from experiments.tables.parts import as_json, made_of, plain

ROUNDING_M = 1e-6


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = rows_of("box_paths")
    times_s, spare_m = numbers(study.rows, "planning_s"), numbers(study.rows, "spare_m")
    low_s, high_s = np.quantile(times_s, (0.05, 0.95)).tolist()
    summary = {
        "n": len(study.rows),
        "statuses": dict(Counter(row["status"] for row in study.rows)),
        "n_exact": len(spare_m),
        "n_too_close": sum(one_m < -ROUNDING_M for one_m in spare_m),
        "least_spare_m": min(spare_m),
        "planning_s": plain(median(times_s), 4),
        "low_s": round(low_s, 4),
        "high_s": round(high_s, 4),
        "longest_s": round(max(times_s), 4),
    }
    return {"box_paths.json": as_json(made_of(box_paths=study), summary)}
