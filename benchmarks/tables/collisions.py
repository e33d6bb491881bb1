"""Random requests whose paths were judged by an independent exact test."""

from collections import Counter

from agent_proc.statistics.intervals import median, share
from benchmarks.tables.rows import numbers, rows_of
from experiments.tables.parts import as_json, made_of, plain


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = rows_of("planner_collisions")
    rows = study.rows
    planning_s = numbers(rows, "planning_s")
    n_planned, n_collided = (sum(row[key] > 0 for row in rows) for key in ("n_paths", "n_colliding"))
    summary = {
        "requests": len(rows),
        "paths": sum(row["n_paths"] for row in rows),
        "colliding_paths": sum(row["n_colliding"] for row in rows),
        "colliding_share_of_requests": plain(share(n_collided, n_planned), 6),
        "least_margin_m": min(numbers(rows, "least_margin_m")),
        "other_faults": [f"{row['number']}: {row['faults']}" for row in rows if row["faults"]],
        "statuses": dict(Counter(row["status"] for row in rows)),
        "by_planner": {
            name: dict(Counter(row["status"] for row in rows if f"{row['planner']}, {row['steering']}" == name))
            for name in sorted({f"{row['planner']}, {row['steering']}" for row in rows})
        },
        "planning_s_median": plain(median(planning_s), 4),
        "planning_s_longest": max(planning_s),
    }
    return {"planner_collisions.json": as_json(made_of(planner_collisions=study), summary)}
