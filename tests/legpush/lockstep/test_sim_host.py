"""A process of several simulators: what it is asked for on its command line, what each is called, and how it ends."""

import subprocess
import sys
import threading
from collections.abc import Callable, Collection
from contextlib import nullcontext
from datetime import UTC, datetime
from pathlib import Path

import pytest

from legpush.bus import channels, keys
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints
from legpush.bus.secure.host_folder import Credentials
from legpush.errors import ConfigError
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.lockstep.server import serve_actions
from legpush.lockstep.sim_host import SimConfig, buses, member_name, serve_each
from legpush.lockstep.simulator import Stepper
from legpush.messages.stepping import Walk
from legpush.soak.stub_simulator import StubSimulator
from tests.legpush.bus.memory_session import RUN, MemoryNetwork
from tests.legpush.examples import RESET
from tests.legpush.fakes import eventually

STUB = [sys.executable, "-P", "-m", "legpush.soak.stub_simulator"]


def test_members_have_names_and_incarnations_that_tell_their_process() -> None:
    network, stop = MemoryNetwork(), threading.Event()
    with buses(SimConfig(run=RUN, name="robot", simulators=3), Endpoints(), stop, network.open_session) as members:
        assert [bus.name for bus in members] == ["robot-1", "robot-2", "robot-3"]
        assert len({keys.process_of(bus.incarnation) for bus in members} - {None}) == 1
        assert len({bus.incarnation for bus in members}) == 3
        assert len(network.sessions) == 1
    assert network.sessions == []


def test_members_tell_about_links_once_and_do_not_take_one_another_for_others(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[Callable[[], Collection[str]]] = []

    def watch(_: Credentials, __: object, ___: object, roles: Callable[[], Collection[str]]) -> nullcontext[None]:
        shown.append(roles)
        return nullcontext()

    monkeypatch.setattr("legpush.bus.secure.link_watch.LinkWatch", watch)
    ends = datetime(2027, 1, 1, tzinfo=UTC)
    at = Endpoints(credentials=Credentials(folder=Path("/x"), role="sim", name="sim.robot.1", ends=ends, names={}))
    network = MemoryNetwork()
    with buses(SimConfig(run=RUN, simulators=3), at, threading.Event(), network.open_session) as members:
        for bus in members:
            bus.announce()
        (roles,) = shown
        assert roles() == set()
        with network.bus("agent") as agent:
            agent.announce()
            assert roles() == {"agent"}
            assert len(agent.liveliness.live("sim")) == 3


def test_each_process_has_a_name_of_its_own() -> None:
    network, stop = MemoryNetwork(), threading.Event()
    config = SimConfig(run=RUN, simulators=2)
    with (
        buses(config, Endpoints(), stop, network.open_session) as one,
        buses(config, Endpoints(), stop, network.open_session) as other,
    ):
        assert keys.process_of(one[0].incarnation) != keys.process_of(other[0].incarnation)


def test_a_failure_of_one_ends_all_of_them() -> None:
    network, stop = MemoryNetwork(), threading.Event()

    def make(bus: Bus) -> Stepper:
        if bus.name.endswith("-2"):
            bus.subscribe = fail  # type: ignore[method-assign, assignment]
        return StubSimulator()

    def fail(*_: object) -> None:
        raise ZeroDivisionError("a fault")

    with (
        pytest.raises(ZeroDivisionError, match="a fault"),
        buses(SimConfig(run=RUN, simulators=3), Endpoints(), stop, network.open_session) as members,
    ):
        serve_each(members, make, stop)
    assert stop.is_set()
    assert network.sessions == []


@pytest.mark.parametrize("simulators", [0, 257, -1])
def test_a_number_of_simulators_that_no_process_has_is_refused(simulators: int) -> None:
    with pytest.raises(ConfigError, match=rf"Expected 1 to 256 for --simulators, got {simulators}"):
        SimConfig(simulators=simulators)


def test_a_name_that_is_too_long_with_its_number_is_refused() -> None:
    assert SimConfig(name="x" * 64).name == "x" * 64
    longest = "x" * 61
    assert SimConfig(name=longest, simulators=12).name == longest
    with pytest.raises(ConfigError, match=r"Expected 1 to 61 letters, .* for --name with --simulators 12, got 'x{62}'"):
        SimConfig(name="x" * 62, simulators=12)
    assert member_name("a", 12) == "a-12"


def test_the_command_line_has_the_number_and_refuses_a_wrong_one() -> None:
    wrong = subprocess.run([*STUB, "--simulators", "0"], capture_output=True, text=True, timeout=60, check=False)
    assert wrong.returncode == 2
    assert "for --simulators, got 0" in wrong.stderr
    assert "Traceback" not in wrong.stderr


def test_quick_steps_are_one_status_and_a_pause_another() -> None:
    network, stop = MemoryNetwork(), threading.Event()
    with network.bus("sim") as sim, network.bus("agent") as agent:
        heard = agent.subscribe(channels.statuses(sim.run, "sim"))
        serving = threading.Thread(target=serve_actions, args=(sim, StubSimulator(), stop))
        serving.start()
        agent.announce()
        world = BusWorld(SimLink(agent, "main", stop=stop))
        world.step(RESET)
        for _ in range(200):
            world.step(Walk())
        phases = [status.phase for status in heard.drain()]
        assert eventually(lambda: [status.phase for status in heard.drain()][-1:] == ["idle"])
        stop.set()
        serving.join(10.0)
    assert len(phases) < 5
