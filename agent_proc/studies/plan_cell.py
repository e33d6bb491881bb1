"""The kind of cell `plan`: one query to the planner."""

from collections.abc import Collection, Mapping
from time import perf_counter
from typing import Any, Final, Literal

from msgspec import Struct

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.queries import query_for_box
from agent_proc.studies.cell_parts import path_changes, planner, scenario_of
from legpush.fields import Seed
from legpush.messages.codec import checksum, encode
from legpush.messages.planning import PlanQuery
from legpush.plans.trunk_queries import query_to_nominal_box
from legpush.scene.faces import PUSHABLE, pushed_box
from legpush.scene.names import PlannerName, Steering
from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column

Path = Literal["trunk", "box"]

COLUMNS: Final = (
    Column(name="status", unit="", about="exact, approximate, failed or invalid"),
    Column(name="reason", unit="", about="why the plan has this status"),
    Column(name="length_m", unit="m", about="length of the path"),
    Column(name="min_clearance_m", unit="m", about="least distance from the path to any occupied cell"),
    Column(name="n_waypoints", unit="", about="number of waypoints"),
    Column(name="n_iterations", unit="", about="iterations of the search"),
    Column(name="n_plans", unit="", about="number of plans, the last of which counts"),
    Column(name="plan_crc", unit="", about="CRC-32 of the plan as a message"),
    Column(name="first_plan_s", unit="s", about="time until the first plan", may_differ=True),
    Column(name="all_plans_s", unit="s", about="time until the last plan", may_differ=True),
)


class PlanCell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A query as a study file sets it."""

    seed: Seed = 0
    """Seed of the search."""
    scenario: str = "default"
    """A built-in scenario or the path of a scenario file."""
    path: Path = "trunk"
    """`trunk`: from the start to the first face of the box. `box`: from the box to its goal."""
    planner: PlannerName | None = None
    """Replaces the scenario's search."""
    steering: Steering | None = None
    """Replaces the scenario's steering of paths."""
    turning_radius_m: float | None = None
    """Replaces the least turning radius of the robot's paths."""
    changes: dict[str, Any] = {}
    """Other fields of the scenario, by their path."""


class ResolvedPlan(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A query that needs no other file."""

    seed: Seed
    scenario: Scenario
    path: Path


def resolve(cell: PlanCell, _: Collection[str]) -> ResolvedPlan:
    """Load the scenario.

    Raises:
        ScenarioError: The scenario or a change cannot be used.
    """
    changes = {**cell.changes, **path_changes(cell.planner, cell.steering, cell.turning_radius_m)}
    return ResolvedPlan(seed=cell.seed, scenario=scenario_of(cell.scenario, changes), path=cell.path)


def run(cell: ResolvedPlan) -> Mapping[str, Any]:
    """Ask the planner."""
    query = _query(cell)
    began_s = perf_counter()
    ends_s, plans = [], []
    for plan in planner()(query, lambda: False):
        plans.append(plan)
        ends_s.append(perf_counter() - began_s)
    last = plans[-1]
    return {
        "status": last.status,
        "reason": last.reason,
        "length_m": last.length_m,
        "min_clearance_m": last.min_clearance_m,
        "n_waypoints": len(last.waypoints),
        "n_iterations": last.n_iterations,
        "n_plans": len(plans),
        "plan_crc": f"{checksum(encode(last)):08x}",
        "first_plan_s": ends_s[0],
        "all_plans_s": ends_s[-1],
    }


def _query(cell: ResolvedPlan) -> PlanQuery:
    scenario = cell.scenario
    faces = tuple(face for face in scenario.pushing.faces if face in PUSHABLE[scenario.box.shape])
    if cell.path == "trunk":
        return query_to_nominal_box(scenario, cell.seed, scenario.start.pose(), faces[0])
    estimates = {face: PushEstimate(pushed_box(scenario.box, face)) for face in faces}
    return query_for_box(scenario, cell.seed, scenario.box.pose.pose(), estimates, None)


PLAN: Final = CellKind(
    specification=PlanCell, run=run, resolved=ResolvedPlan, resolve=resolve, columns=COLUMNS, changes=Scenario
)
"""The kind of cell."""
