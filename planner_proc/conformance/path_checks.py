"""Checks of paths, one function each, which returns what is wrong, or an empty text."""

from typing import Final

from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.names import Steering
from planner_proc.conformance.bench import EASY, REMARK, Bench
from planner_proc.conformance.box_truth import box_faults
from planner_proc.conformance.cases import BESIDE_A_WALL, Case, box_query
from planner_proc.conformance.truth import body_faults, faults

RADIUS_M: Final = 0.5
"""Turning radius to ask for."""


def plans(bench: Bench, case: Case) -> str:
    """The plan has an honest status, and a path without faults."""
    result = bench.client.ask(case.query, bench.deadline_s)
    if isinstance(result, str):
        return result
    return judged(case.query, result.plan, case.expected)


def judged(asked: TrunkPathQuery, plan: Plan, expected: tuple[str, ...]) -> str:
    """What is wrong with a plan, its status included; empty if nothing is."""
    found = faults(asked, plan)
    if plan.status not in expected:
        found.insert(0, f"its status is {plan.status} ({plan.reason}), expected {' or '.join(expected)}")
    return "; ".join(found)


def steers(bench: Bench, steering: Steering) -> str:
    """The planner finds a path with a turning radius, or says that it cannot."""
    asked = replace(EASY, planner="rrt", steering=steering, min_turning_radius_m=RADIUS_M, max_iterations=5000)
    result = bench.client.ask(asked, bench.deadline_s)
    if isinstance(result, str):
        return result
    if result.plan.status == "invalid" and result.plan.reason:
        return f"{REMARK}it says that it cannot ({result.plan.reason})"
    return judged(asked, result.plan, ("exact",))


def minds_the_body(bench: Bench) -> str:
    """The planner turns the body of the robot where it has room, or its path is only one for a disc."""
    asked = BESIDE_A_WALL
    result = bench.client.ask(asked, bench.deadline_s)
    if isinstance(result, str):
        return result
    if result.plan.status in ("failed", "invalid") and result.plan.reason:
        return f"{REMARK}it has no path for the body ({result.plan.reason}); in narrow rooms, missions need one"
    if of_body := body_faults(asked, result.plan):
        return f"{REMARK}it plans for a disc alone, so robots touch walls where they turn: {of_body[0]}"
    return judged(asked, result.plan, ("exact",))


def knows_boxes(bench: Bench, goal: Pose2) -> str:
    """The planner finds a path of the box, or says that it cannot."""
    asked = box_query(goal)
    result = bench.client.ask(asked, bench.deadline_s)
    if isinstance(result, str):
        return result
    plan = result.plan
    if plan.status in ("failed", "invalid") and plan.reason:
        return f"{REMARK}it has none ({plan.reason}); missions need them"
    if plan.status != "exact":
        return f"its status is {plan.status} ({plan.reason}), expected exact"
    return "; ".join(box_faults(asked, plan))
