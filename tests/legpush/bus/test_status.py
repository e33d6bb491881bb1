"""The status of a process: published when it changes, and again as a heartbeat."""

from collections.abc import Callable, Iterator

import pytest

from legpush.bus import channels, status
from legpush.bus.bus import Bus
from legpush.bus.ports import Subscription
from legpush.bus.status import StatusBeacon
from legpush.messages.telemetry import Status
from tests.legpush.bus.memory_session import RUN, MemoryNetwork
from tests.legpush.fakes import eventually


@pytest.fixture
def pair() -> Iterator[tuple[Bus, Subscription[Status]]]:
    """A simulator, and what an agent hears of its statuses."""
    network = MemoryNetwork()
    with network.bus("sim") as sim, network.bus("agent") as agent:
        yield sim, agent.subscribe(channels.statuses(RUN))


def phases_of(heard: Subscription[Status]) -> Callable[[], list[str]]:
    """The phases that were published, up to now."""
    phases: list[str] = []

    def drain() -> list[str]:
        phases.extend(message.phase for message in heard.drain())
        return phases

    return drain


def test_a_change_is_out_when_the_call_returns(pair: tuple[Bus, Subscription[Status]]) -> None:
    sim, heard = pair
    StatusBeacon(sim).publish_status("walking", 0.5, "4 of 8 m", "planner")
    message = heard.next(0.0)
    assert message is not None
    assert (message.phase, message.fraction, message.detail, message.waiting_for) == (
        "walking",
        0.5,
        "4 of 8 m",
        "planner",
    )


def test_changes_that_follow_fast_are_published_as_one(
    pair: tuple[Bus, Subscription[Status]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(status, "SHORTEST_PERIOD_S", 0.05)
    sim, heard = pair
    phases = phases_of(heard)
    with StatusBeacon(sim) as beacon:
        for number in range(20):
            beacon.publish_status(str(number))
        assert eventually(lambda: phases()[-1:] == ["19"])
    assert phases()[0] == "0"
    assert len(phases()) < 20


def test_what_does_not_change_is_published_again_and_again(
    pair: tuple[Bus, Subscription[Status]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(status, "SHORTEST_PERIOD_S", 0.005)
    monkeypatch.setattr(status, "PERIOD_S", 0.02)
    sim, heard = pair
    phases = phases_of(heard)
    with StatusBeacon(sim, "starting"):
        assert eventually(lambda: len(phases()) >= 3)
    assert set(phases()) == {"starting"}


def test_what_is_said_again_without_a_change_is_left_to_the_heartbeat(
    pair: tuple[Bus, Subscription[Status]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(status, "SHORTEST_PERIOD_S", 0.0)
    sim, heard = pair
    beacon = StatusBeacon(sim)
    for phase in ("stepping", "stepping", "stepping", "idle", "idle", "stepping"):
        beacon.publish_status(phase)
    assert phases_of(heard)() == ["stepping", "idle", "stepping"]
