"""Verdicts on answers."""

from types import SimpleNamespace
from typing import Any

from msgspec.structs import replace

from legpush.messages.planning import Plan
from planner_proc.conformance.bench import EASY, REMARK
from planner_proc.conformance.cases import BESIDE_A_WALL
from planner_proc.conformance.path_checks import judged, minds_the_body
from planner_proc.planning import make_plan


def test_an_honest_answer_has_nothing_wrong() -> None:
    assert judged(EASY, make_plan(EASY), ("exact",)) == ""
    assert judged(EASY, Plan(status="failed", reason="no way"), ("approximate", "failed")) == ""


def test_an_unexpected_status_comes_before_all_other_faults() -> None:
    plan = replace(make_plan(EASY), status="approximate", reason="nearly")

    assert judged(EASY, plan, ("exact",)) == "its status is approximate (nearly), expected exact"
    broken = replace(plan, waypoints=plan.waypoints[5:])
    assert judged(EASY, broken, ("exact", "failed")).startswith(
        "its status is approximate (nearly), expected exact or failed; it begins at"
    )


def bench(plan: Plan) -> Any:
    """A planner that always gives this plan."""
    return SimpleNamespace(
        client=SimpleNamespace(ask=lambda query, deadline_s: SimpleNamespace(plan=plan)), deadline_s=1.0
    )


def test_a_planner_that_knows_no_body_gets_a_remark() -> None:
    disc = make_plan(replace(BESIDE_A_WALL, body=None))

    assert minds_the_body(bench(make_plan(BESIDE_A_WALL))) == ""
    assert minds_the_body(bench(disc)).startswith(f"{REMARK}it plans for a disc alone")
    assert minds_the_body(bench(Plan(status="failed", reason="no way"))).startswith(
        f"{REMARK}it has no path for the body"
    )
    assert minds_the_body(bench(Plan(status="failed", reason=""))) == (
        "its status is failed (), expected exact; its status is failed, and its reason is empty"
    )
