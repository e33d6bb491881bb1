"""Who is alive, who says nothing and who is gone."""

from legpush.history.run_history import Said
from legpush.messages.common import Role
from legpush.messages.telemetry import Origin, Status
from sim_proc.view.statuses import Condition, conditions
from tests.legpush.recording.recordings import header

S = 1_000_000_000


def said(role: Role, at_s: float, phase: str = "idle", waiting_for: str = "") -> Said:
    origin = Origin(role=role, name="main", incarnation=f"{role}-1")
    status = Status(header=header(origin, 0), phase=phase, waiting_for=waiting_for)
    return Said(time_ns=round(at_s * S), origin=origin, status=status)


def by_role(found: list[Condition]) -> dict[str, str]:
    return {each.role: each.health for each in found}


def test_in_a_recording_whoever_has_not_spoken_for_three_seconds_is_gone() -> None:
    spoken = [said("planner", 10.0), said("sim", 13.0), said("agent", 13.5, "walking", "sim/main")]

    found = conditions(spoken, 14 * S, None)

    assert by_role(found) == {"planner": "gone", "sim": "alive", "agent": "alive"}
    assert (found[2].phase, found[2].waiting_for) == ("walking", "sim/main")


def test_what_is_said_later_is_not_known_yet() -> None:
    found = conditions([said("agent", 10.0, "walking"), said("agent", 12.0, "pushing")], 11 * S, None)
    assert found[2].phase == "walking"


def test_live_whoever_is_there_and_says_nothing_is_silent_and_whoever_is_not_there_is_gone() -> None:
    spoken = [said("planner", 1.0), said("sim", 19.5), said("agent", 19.5)]
    live = [each.origin for each in spoken[:2]]

    assert by_role(conditions(spoken, 20 * S, live)) == {"planner": "silent", "sim": "alive", "agent": "gone"}


def test_roles_that_nobody_has_are_named_all_the_same() -> None:
    assert by_role(conditions([], 0, [])) == {"planner": "gone", "sim": "gone", "agent": "gone"}
