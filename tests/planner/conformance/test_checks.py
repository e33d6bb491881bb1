"""Choosing checks by name, and running them, with a planner and clients that only pretend."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from legpush.errors import ConfigError
from legpush.messages.planning import Plan
from planner_proc.conformance.bench import Bench
from planner_proc.conformance.checks import run_checks
from planner_proc.planning import make_plan


def bench(*, wrong: str = "", dies: bool = False) -> tuple[Bench, list[str]]:
    """A bench whose client answers with the built-in planner, and a record of what the process did."""
    happened: list[str] = []

    def ask(query: Any, _: float) -> SimpleNamespace:
        return SimpleNamespace(plan=make_plan(query))

    client = SimpleNamespace(wait_for_planner=lambda _: wrong, ask=ask)
    planner = SimpleNamespace(
        end=lambda: "it died" if dies else "",
        kill=lambda: happened.append("killed"),
        start=lambda: happened.append("started"),
    )
    made: Any = Bench(planner=cast(Any, planner), client=cast(Any, client), other=cast(Any, client), deadline_s=1.0)
    return made, happened


def test_checks_are_chosen_by_a_part_of_their_name_and_run_in_order() -> None:
    found = list(run_checks(bench()[0], ("open floor", "narrow gate")))

    assert [(finding.name, finding.passed) for finding in found] == [
        ("starts and shows its token", True),
        ("plans: open floor", True),
        ("plans: narrow gate", True),
    ]


def test_a_part_of_no_name_is_refused_before_the_planner_is_asked() -> None:
    with pytest.raises(ConfigError, match=r"a part of the name of a check for --only \(plans: open floor, .*'poetry'"):
        next(run_checks(bench(wrong="never asked")[0], ("poetry",)))


def test_nothing_is_checked_of_a_planner_that_does_not_start() -> None:
    (only,) = run_checks(bench(wrong="no token")[0])

    assert (only.passed, only.reason) == (False, "no token")


def test_a_planner_that_ended_is_started_again_for_the_next_check() -> None:
    made, happened = bench(dies=True)
    list(run_checks(made, ("open floor", "narrow gate")))

    assert happened == ["killed", "started"] * 2


def test_a_planner_that_failed_a_check_is_started_again_for_the_next_one(monkeypatch: pytest.MonkeyPatch) -> None:
    made, happened = bench()
    right = made.client.ask
    monkeypatch.setattr(made.client, "ask", lambda *_: "no answer within 1 s")
    findings = run_checks(made, ("open floor", "narrow gate"))
    assert next(findings).passed
    assert (next(findings).reason, happened) == ("no answer within 1 s", ["killed", "started"])
    monkeypatch.setattr(made.client, "ask", right)
    assert all(finding.passed for finding in findings)
    assert happened == ["killed", "started"]


def test_a_remark_is_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    made, _ = bench()
    answer = SimpleNamespace(plan=Plan(status="invalid", reason="only straight lines"))
    monkeypatch.setattr(made.client, "ask", lambda *_: answer)
    _, finding = run_checks(made, ("(Dubins)",))

    assert finding.passed
    assert finding.reason == "it says that it cannot (only straight lines)"
