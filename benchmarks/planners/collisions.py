"""Judges the paths of thousands of random requests by an exact geometric test that shares no code with the planner."""

import json
from collections import Counter
from dataclasses import asdict, dataclass
from math import inf
from time import perf_counter
from typing import Final

import numpy as np

from agent_proc.statistics.intervals import median, share
from benchmarks.planners.random_requests import random_request
from benchmarks.planners.tables import RESULTS, Row, fill, numbers
from legpush.scene.clearance import clearance
from planner_proc.conformance.truth import SAME_M, faults
from planner_proc.planning import make_plans

TABLE: Final = RESULTS / "planner_collisions.csv.gz"
SUMMARY: Final = RESULTS / "planner_collisions.json"


@dataclass(frozen=True, kw_only=True)
class Collisions:
    """Plan random requests and judge each path at the required clearance."""

    n: int = 10_000
    """Number of requests."""


def main(config: Collisions) -> None:
    """Judge the requests that are not in the table yet, and summarize all."""
    rows = fill(TABLE, ("number",), [(number,) for number in range(config.n)], judged)
    n_planned = sum(int(row["n_paths"]) > 0 for row in rows)
    n_collided = sum(int(row["n_colliding"]) > 0 for row in rows)
    n_paths = sum(int(row["n_paths"]) for row in rows)
    other = [f"{row['number']}: {row['faults']}" for row in rows if row["faults"]]
    summary = {
        "requests": len(rows),
        "paths": n_paths,
        "colliding_paths": sum(int(row["n_colliding"]) for row in rows),
        "colliding_share_of_requests": asdict(share(n_collided, n_planned).rounded(6)),
        "least_margin_m": min(numbers(rows, "least_margin_m")),
        "other_faults": other,
        "statuses": dict(Counter(row["status"] for row in rows)),
        "by_planner": {
            name: dict(Counter(row["status"] for row in rows if f"{row['planner']}, {row['steering']}" == name))
            for name in sorted({f"{row['planner']}, {row['steering']}" for row in rows})
        },
        "planning_s_median": asdict(median(numbers(rows, "planning_s")).rounded(4)),
        "planning_s_longest": max(numbers(rows, "planning_s")),
    }
    SUMMARY.write_text(json.dumps(summary, indent=1) + "\n")
    print(json.dumps(summary, indent=1))


def judged(number: int) -> Row:
    """Plan one request and judge every revision of its plan; return a row of the table."""
    query = random_request(number)
    begin_s = perf_counter()
    plans = list(make_plans(query, lambda: False))
    planning_s = perf_counter() - begin_s
    found, least_m, n_colliding, n_paths = list[str](), inf, 0, 0
    for plan in plans:
        found += faults(query, plan)
        if plan.status in ("exact", "approximate"):
            points = np.array([waypoint.xy() for waypoint in plan.waypoints])
            margin_m = clearance(query.grid, points).distance_m - query.clearance_m
            least_m = min(least_m, margin_m)
            n_paths += 1
            n_colliding += margin_m < -SAME_M
    return {
        "planner": query.planner,
        "steering": query.steering,
        "status": plans[-1].status,
        "n_paths": n_paths,
        "n_colliding": n_colliding,
        "least_margin_m": f"{least_m:.9f}" if n_paths else "",
        "faults": "; ".join(found),
        "planning_s": round(planning_s, 4),
    }
