"""The kind of cell that asks a planner of legpush for a path, with improvements, and measures every answer.

All planners get equal budgets of iterations, and steered ones a smaller one, as their iterations take many times as
long.
"""

from collections.abc import Mapping
from dataclasses import asdict
from time import perf_counter
from typing import Any, Final

from msgspec import Struct
from msgspec.structs import replace

from benchmarks.planners.maps import question
from benchmarks.planners.measures import measured, points_of
from legpush.fields import Seed
from legpush.messages.planning import Plan
from legpush.scene.names import PlannerName, Steering
from legpush.scene.plan_settings import Anytime
from legpush.study.cells import CellKind, Column, as_it_is
from planner_proc.planning import make_plans

RADIUS_M: Final = 0.4
"""Turning radius of the steered planners."""
BUDGET: Final = 3000
IMPROVEMENTS: Final = Anytime(n_improvements=3, improvement_iterations=300)
STEERED_BUDGET: Final = 600
STEERED_IMPROVEMENTS: Final = Anytime(n_improvements=3, improvement_iterations=60)
MEASURES: Final = (
    Column(name="length_m", unit="m", about="length of the last path"),
    Column(name="clearance_m", unit="m", about="least clearance of the last path"),
    Column(name="curvature_rms_per_m", unit="1/m", about="curvature of the last path, root mean square"),
    Column(name="keeps_clearance", unit="", about="whether the last path keeps the required clearance"),
)
COLUMNS: Final = (
    Column(name="status", unit="", about="of the last plan: exact, approximate, failed or invalid"),
    Column(name="first_s", unit="s", about="time until the first exact path", may_differ=True),
    Column(name="final_s", unit="s", about="time until the last plan", may_differ=True),
    Column(name="first_length_m", unit="m", about="length of the first exact path"),
    *MEASURES,
)


class Compared(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A planner, a map and a seed."""

    seed: Seed
    map: str
    """One of `benchmarks.planners.maps`."""
    planner: PlannerName
    steering: Steering = "straight"


def compared(cell: Compared) -> Mapping[str, Any]:
    """Plan one request with improvements and time each answer."""
    straight = cell.steering == "straight"
    changes: dict[str, Any] = {
        "planner": cell.planner,
        "steering": cell.steering,
        "seed": cell.seed,
        "max_iterations": BUDGET if straight else STEERED_BUDGET,
        "anytime": IMPROVEMENTS if straight else STEERED_IMPROVEMENTS,
        "min_turning_radius_m": 0.0 if straight else RADIUS_M,
    }
    query = replace(question(cell.map), **changes)
    plans: list[Plan] = []
    times_s: list[float] = []
    begin_s = perf_counter()
    for plan in make_plans(query, lambda: False):
        plans.append(plan)
        times_s.append(perf_counter() - begin_s)
    first = next((k for k, plan in enumerate(plans) if plan.status == "exact"), None)
    row: dict[str, Any] = {"status": plans[-1].status, "final_s": times_s[-1]}
    if first is None:
        return {**row, "first_s": None, "first_length_m": None, **dict.fromkeys(column.name for column in MEASURES)}
    row |= {"first_s": times_s[first], "first_length_m": plans[first].length_m}
    return row | asdict(measured(query, points_of(plans[-1])))


COMPARED: Final = CellKind(specification=Compared, run=compared, resolved=Compared, resolve=as_it_is, columns=COLUMNS)
"""The kind of cell."""
