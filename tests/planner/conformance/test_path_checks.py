"""Verdicts on answers."""

from msgspec.structs import replace

from legpush.messages.planning import Plan
from planner_proc.conformance.bench import EASY
from planner_proc.conformance.path_checks import judged
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
