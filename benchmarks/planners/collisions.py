"""The kind of cell that judges the path of a random request by an exact geometric test.

The test shares no code with the planner.
"""

from collections.abc import Mapping
from math import inf
from time import perf_counter
from typing import Annotated, Any, Final

import numpy as np
from msgspec import Meta, Struct

from benchmarks.planners.random_requests import random_request
from legpush.scene.clearance import clearance
from legpush.study.cells import CellKind, Column, as_it_is
from planner_proc.conformance.truth import SAME_M, faults
from planner_proc.planning import make_plans

COLUMNS: Final = (
    Column(name="planner", unit="", about="the search of the request"),
    Column(name="steering", unit="", about="the steering of the request"),
    Column(name="status", unit="", about="of the last plan: exact, approximate, failed or invalid"),
    Column(name="n_paths", unit="", about="plans with a path"),
    Column(name="n_colliding", unit="", about="paths that come closer than the required clearance"),
    Column(name="least_margin_m", unit="m", about="least distance beyond the required clearance"),
    Column(name="faults", unit="", about="what else is wrong with the plans"),
    Column(name="planning_s", unit="s", about="time for all plans", may_differ=True),
)


class RandomRequest(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A random request by its number."""

    number: Annotated[int, Meta(ge=0)]


def judged(cell: RandomRequest) -> Mapping[str, Any]:
    """Plan one request and judge every revision of its plan at the required clearance."""
    query = random_request(cell.number)
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
        "n_colliding": int(n_colliding),
        "least_margin_m": least_m if n_paths else None,
        "faults": "; ".join(found),
        "planning_s": planning_s,
    }


JUDGED: Final = CellKind(
    specification=RandomRequest,
    run=judged,
    resolved=RandomRequest,
    resolve=as_it_is,
    columns=COLUMNS,
)
"""The kind of cell."""
