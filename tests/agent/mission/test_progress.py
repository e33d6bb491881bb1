"""The progress of a mission as its peers and people read it."""

import logging

import pytest

from agent_proc.mission.progress import MissionProgress
from legpush.bus import channels
from legpush.bus.status import StatusBeacon
from legpush.messages.telemetry import Status
from tests.legpush.bus.memory_session import RUN, MemoryNetwork


@pytest.fixture(autouse=True)
def every_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """Changes that follow fast are published one by one."""
    monkeypatch.setattr("legpush.bus.status.SHORTEST_PERIOD_S", 0.0)


def published(*told: tuple[str, float | None, str] | str) -> list[Status]:
    """What is published when a mission tells phases, and waits for peers by name."""
    network = MemoryNetwork()
    with network.bus("agent") as agent, network.bus("sim") as sim:
        heard = sim.subscribe(channels.statuses(RUN))
        progress = MissionProgress(StatusBeacon(agent))
        for each in told:
            if isinstance(each, str):
                progress.wait(each)
            else:
                progress.tell(*each)
        return list(heard.drain())


def test_phase_share_and_detail_are_published() -> None:
    (status,) = published(("walking", 0.5, "2 of 4 m"))

    assert (status.phase, status.fraction, status.detail, status.waiting_for) == ("walking", 0.5, "2 of 4 m", "")


def test_the_phase_stays_while_a_peer_is_waited_for_and_after_that() -> None:
    statuses = published(("walking", 0.5, "2 of 4 m"), "planner", "")

    assert [status.waiting_for for status in statuses] == ["", "planner", ""]
    assert {(status.phase, status.fraction, status.detail) for status in statuses} == {("walking", 0.5, "2 of 4 m")}


def test_a_mission_that_waits_before_it_tells_anything_is_starting() -> None:
    (status,) = published("sim")

    assert (status.phase, status.fraction, status.waiting_for) == ("starting", None, "sim")


def test_what_each_phase_begins_with_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, logger="agent_proc.mission.progress")

    published(("walking", 0.0, "0 of 4 m"), ("walking", 0.5, "2 of 4 m"), ("pushing", None, "cycle 0"))

    assert caplog.messages == ["walking: 0 of 4 m", "pushing: cycle 0"]
