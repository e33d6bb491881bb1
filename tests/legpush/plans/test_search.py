"""The search for the plans of one query: what a planner that fails answers."""

from collections.abc import Iterator
from math import inf, nan

import pytest
from msgspec.structs import replace

from legpush.errors import RecordingError
from legpush.messages.planning import Plan, PlanQuery
from legpush.plans.planner import Interrupted, PlanningInterruptedError
from legpush.plans.search import search_plans
from tests.legpush.examples import PLAN, QUERY

FAILURES = (ValueError("no"), MemoryError(), KeyError("x"), ZeroDivisionError("division"), RecursionError("deep"))


class Planner:
    """Makes some plans, then raises an error if there is one."""

    def __init__(self, *plans: Plan, error: Exception | None = None) -> None:
        self._plans = plans
        self._error = error

    def __call__(self, query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
        yield from self._plans
        if self._error is not None:
            raise self._error


def searched(planner: Planner) -> list[Plan]:
    """All plans of a search."""
    return list(search_plans(planner, QUERY, lambda: False))


def test_the_plans_are_those_of_the_planner() -> None:
    better = replace(PLAN, length_m=1.0)
    assert searched(Planner(PLAN, better)) == [PLAN, better]


@pytest.mark.parametrize("error", FAILURES, ids=repr)
def test_a_planner_that_fails_at_once_answers_failed(error: Exception, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    (plan,) = searched(Planner(error=error))
    assert (plan.status, plan.reason) == ("failed", f"The planner failed: {type(error).__name__}: {error}")
    assert "Traceback" in caplog.text
    assert {record.levelname for record in caplog.records} == {"INFO"}


def test_a_planner_that_fails_later_has_no_better_plans() -> None:
    assert searched(Planner(PLAN, error=ValueError("no"))) == [PLAN]


def test_a_planner_without_plans_answers_failed() -> None:
    assert [plan.status for plan in searched(Planner())] == ["failed"]


@pytest.mark.parametrize("length_m", [nan, inf])
def test_a_plan_that_no_message_can_hold_is_not_made(length_m: float) -> None:
    impossible = replace(PLAN, length_m=length_m)
    (plan,) = searched(Planner(impossible))
    assert plan.status == "failed"
    assert "finite" in plan.reason
    assert searched(Planner(PLAN, impossible)) == [PLAN]


def test_a_planner_that_does_not_even_begin_answers_failed() -> None:
    def refuse(query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
        raise TypeError(f"not {query.seed}")

    (plan,) = search_plans(refuse, QUERY, lambda: False)
    assert plan.status == "failed"


@pytest.mark.parametrize("error", [PlanningInterruptedError(), RecordingError("no such query")], ids=repr)
def test_an_interruption_and_the_end_of_a_recording_go_on(error: Exception) -> None:
    with pytest.raises(type(error)):
        searched(Planner(PLAN, error=error))
