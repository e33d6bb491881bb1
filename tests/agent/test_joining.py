"""Which simulators of a run are joined, and which are spare, on a network in memory."""

from collections.abc import Iterator
from contextlib import ExitStack
from threading import Event

import pytest

from agent_proc.joining import Roster
from legpush.bus.bus import Bus
from legpush.bus.status import StatusBeacon
from legpush.errors import PeerError, StopRequestedError
from legpush.messages.common import PROTOCOL_VERSION
from tests.legpush.bus.memory_session import RUN, MemoryNetwork

USUAL = "x86-64-v3/1a2b3c4d, motions 4"
OTHER = "native/99999999, motions 4"


class Hosts:
    """Simulators that come and go."""

    def __init__(self, network: MemoryNetwork) -> None:
        self._network = network
        self._running: dict[str, ExitStack] = {}

    def start(self, name: str, numerics: str = USUAL) -> None:
        """A simulator says what it computes with."""
        running = self._running[name] = ExitStack()
        bus = running.enter_context(self._network.bus("sim", name))
        bus.announce()
        StatusBeacon(bus, numerics=numerics).publish_status("idle")

    def stop(self, name: str) -> None:
        """Its token goes."""
        self._running.pop(name).close()

    def stop_all(self) -> None:
        """Nobody is there any more."""
        for name in tuple(self._running):
            self.stop(name)


@pytest.fixture
def network() -> MemoryNetwork:
    """Nobody is there yet."""
    return MemoryNetwork()


@pytest.fixture
def hosts(network: MemoryNetwork) -> Iterator[Hosts]:
    """No simulator yet."""
    hosts = Hosts(network)
    yield hosts
    hosts.stop_all()


@pytest.fixture
def agent(network: MemoryNetwork) -> Iterator[Bus]:
    """The learner."""
    with network.bus("agent") as bus:
        yield bus


def test_the_first_ones_by_name_are_used_and_the_others_are_spare(agent: Bus, hosts: Hosts) -> None:
    roster = Roster(agent)
    for name in ("d", "b", "c", "a"):
        hosts.start(name)

    assert roster.first(2, Event(), 0.0) == ("a", "b")
    hosts.stop("a")
    hosts.stop("b")
    assert [roster.take("a"), roster.take("b")] == ["c", "d"]
    assert not roster.any()
    assert roster.take("c") is None
    hosts.start("later")
    assert roster.any()
    assert roster.take("c") == "later"


def test_one_that_computes_with_other_numerics_is_named_and_never_used(
    agent: Bus, hosts: Hosts, caplog: pytest.LogCaptureFixture
) -> None:
    roster = Roster(agent)
    hosts.start("a", OTHER)
    hosts.start("b")
    hosts.start("c")

    assert roster.first(2, Event(), 0.0) == ("b", "c")
    assert not roster.any()
    assert caplog.text.count(f"sim/a is not used: it computes with {OTHER}, the others with {USUAL}") == 1


def test_too_few_that_fit_together_are_told_with_what_was_found(
    agent: Bus, hosts: Hosts, network: MemoryNetwork
) -> None:
    roster = Roster(agent)
    hosts.start("a", OTHER)
    hosts.start("b")
    network.open_session(agent.endpoints, "old").show_token(f"legpush/v{PROTOCOL_VERSION - 1}/{RUN}/live/sim/old/x")

    told = (
        rf"Expected 2 simulators with equal numerics in run {RUN} .* found a with {OTHER}, b with {USUAL}, "
        rf"old of another version, with protocol {PROTOCOL_VERSION - 1}"
    )
    with pytest.raises(PeerError, match=told):
        roster.first(2, Event(), -1.0)


def test_the_wait_ends_when_it_is_asked_to(agent: Bus) -> None:
    stop = Event()
    stop.set()
    with pytest.raises(StopRequestedError, match="while waiting for 2 simulators"):
        Roster(agent).first(2, stop, 60.0)
