"""Real processes that are killed, frozen and started again: the episode ends in the same state, or says why not."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path
from threading import Event, Thread

import psutil
import pytest

from legpush.bus import endpoints
from legpush.bus.faults import Faults
from legpush.bus.liveliness import LEASE_S
from legpush.errors import PeerError
from legpush.messages.common import Role
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome
from legpush.patience import Patience
from tests.legpush.examples import QUERY
from tests.legpush.fakes import (
    RUN,
    FakeStepper,
    agent,
    bus,
    crc_after,
    eventually,
    fake_plan,
    mission,
    planner,
    sim,
)
from tests.ports import free_ports

RUN_SCRIPT = (sys.executable, str(Path(__file__).with_name("fake_process.py")))
MISSION = mission()
CRC = crc_after(MISSION)


def command(directory: Path, role: Role, *flags: str) -> list[str]:
    """How a fake process is started on the sockets in `directory`."""
    at = endpoints.in_directory(directory, role)
    return [*RUN_SCRIPT, role, "--run", RUN, "--listen", *at.listen, "--connect", *at.connect, *flags]


@contextmanager
def running(command: list[str]) -> Iterator[subprocess.Popen[str]]:
    """The process of this command, killed at the end if it still runs."""
    started = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        yield started
    finally:
        started.kill()
        started.communicate()


def process(directory: Path, role: Role, *flags: str) -> AbstractContextManager[subprocess.Popen[str]]:
    """A fake process on the sockets in `directory`, killed at the end if it still runs."""
    return running(command(directory, role, *flags))


@contextmanager
def process_that_dies_once(directory: Path, role: Role, die_at: int) -> Iterator[None]:
    """A fake process that kills itself, and is then started again by somebody else, as a launcher would."""
    with ExitStack() as stack:
        first = stack.enter_context(process(directory, role, "--die-at", str(die_at)))

        def start_again() -> None:
            if first.wait(30.0) == -signal.SIGKILL:
                stack.enter_context(process(directory, role))

        watcher = Thread(target=start_again)
        watcher.start()
        stack.callback(watcher.join)
        yield


@pytest.mark.parametrize("die_at", [0, 3, 10], ids=["in the reset", "in a walk", "in a push"])
def test_a_simulator_killed_in_a_step_comes_back_to_the_same_state(tmp_path: Path, die_at: int) -> None:
    with process_that_dies_once(tmp_path, "sim", die_at), agent(tmp_path) as asking:
        assert asking.do(MISSION) == CRC


def test_a_simulator_killed_between_steps_and_over_a_bad_channel_comes_back_to_the_same_state(tmp_path: Path) -> None:
    faults = Faults(probability=0.2, seed=1)
    with agent(tmp_path, faults) as asking:
        for n_steps in (1, 5, len(MISSION)):
            with process(tmp_path, "sim", "--inject-faults", "0.2") as started:
                asking.do(MISSION[len(asking.past) : n_steps])
                started.kill()
        assert asking.past[-1].state_crc == CRC
        assert asking.bus.tally["late"] > 0


def test_a_planner_killed_while_it_plans_gives_the_same_plan_when_it_is_back(tmp_path: Path) -> None:
    with process_that_dies_once(tmp_path, "planner", 1), agent(tmp_path) as asking:
        assert [asking.planner.plan(QUERY) for _ in range(3)] == [fake_plan(QUERY)] * 3


def test_a_simulator_that_dies_each_time_in_the_same_step_is_given_up(tmp_path: Path) -> None:
    with agent(tmp_path, patience=Patience(deadline_s=20.0, resend_s=0.02, max_restarts=2)) as asking:
        over = Event()

        def start_again_and_again() -> None:
            while not over.is_set():
                with process(tmp_path, "sim", "--die-at", "2") as started:
                    while started.poll() is None and not over.wait(0.01):
                        pass

        starter = Thread(target=start_again_and_again)
        starter.start()
        try:
            with pytest.raises(PeerError, match=r"sim/main was restarted 3 times .* step"):
                asking.do(MISSION)
        finally:
            over.set()
            starter.join()


@pytest.mark.parametrize("die_when", ["asked", "answered"])
@pytest.mark.parametrize("die_at", [0, 3, 10], ids=["reset", "walk", "push"])
def test_an_agent_killed_in_a_step_goes_on_with_it_and_nothing_is_done_twice(
    tmp_path: Path, die_at: int, die_when: str
) -> None:
    stepper = FakeStepper()
    seeds: list[int] = []

    def make_plan(query: PlanQuery) -> Plan:
        seeds.append(query.seed)
        return fake_plan(query)

    journal = ("--journal", str(tmp_path / "episode-0000.journal"))
    with sim(tmp_path, stepper), planner(tmp_path, make_plan):
        with process(tmp_path, "agent", *journal, "--die-at", str(die_at), "--die-when", die_when) as first:
            assert first.wait(30.0) == -signal.SIGKILL
        with process(tmp_path, "agent", *journal) as second:
            out, err = second.communicate(timeout=30.0)
    assert second.returncode == 0, err
    assert out == f"{QUERY.seed} {CRC}\n"
    assert stepper.performed == MISSION
    assert seeds == [QUERY.seed]


def test_agent_and_simulator_killed_together_end_in_the_same_state(tmp_path: Path) -> None:
    journal = ("--journal", str(tmp_path / "episode-0000.journal"))
    with planner(tmp_path):
        with (
            process(tmp_path, "sim"),
            process(tmp_path, "agent", *journal, "--die-at", "9", "--die-when", "answered") as first,
        ):
            assert first.wait(30.0) == -signal.SIGKILL
        with process(tmp_path, "sim"), process(tmp_path, "agent", *journal) as second:
            assert second.communicate(timeout=30.0)[0] == f"{QUERY.seed} {CRC}\n"


def test_a_frozen_simulator_is_named_and_goes_on_when_it_thaws(tmp_path: Path) -> None:
    with process(tmp_path, "sim") as started, agent(tmp_path, patience=Patience(deadline_s=LEASE_S + 1.0)) as asking:
        asking.do(MISSION[:3])
        started.send_signal(signal.SIGSTOP)
        with pytest.raises(PeerError, match=r"step 3 \(walk\) within 3 s; sim/main is frozen or cut off"):
            asking.do(MISSION[3:])
        started.send_signal(signal.SIGCONT)
        assert asking.do(MISSION[3:]) == CRC


class Slow(FakeStepper):
    """Waits in its sixth motion until it is released."""

    def __init__(self) -> None:
        super().__init__()
        self.began, self.release = Event(), Event()

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        if len(self.performed) == 5:
            self.began.set()
            self.release.wait(30.0)
        return super().perform(motion, with_trace=with_trace)


def test_an_agent_that_is_frozen_until_its_token_is_gone_goes_on_with_its_episode_when_it_thaws(tmp_path: Path) -> None:
    stepper = Slow()
    with sim(tmp_path, stepper) as serving, planner(tmp_path):
        with process(tmp_path, "agent", "--journal", str(tmp_path / "episode-0000.journal")) as started:
            assert stepper.began.wait(30.0)
            started.send_signal(signal.SIGSTOP)
            assert eventually(lambda: serving.liveliness.live("agent") == [])
            stepper.release.set()
            started.send_signal(signal.SIGCONT)
            out, err = started.communicate(timeout=30.0)
        assert out == f"{QUERY.seed} {CRC}\n", err
    assert stepper.performed == MISSION


def test_a_killed_simulator_is_called_dead(tmp_path: Path) -> None:
    with process(tmp_path, "sim") as started, agent(tmp_path, patience=Patience(deadline_s=0.3)) as asking:
        assert eventually(lambda: asking.bus.liveliness.live("sim") != [])
        asking.do(MISSION[:3])
        started.kill()
        with pytest.raises(PeerError, match=r"sim/main is dead: its link closed"):
            asking.do(MISSION[3:])


def test_a_second_simulator_on_the_same_socket_ends_with_one_line_and_the_first_goes_on(tmp_path: Path) -> None:
    with process(tmp_path, "sim") as first, agent(tmp_path) as asking:
        asking.do(MISSION[:3])
        second = subprocess.run(command(tmp_path, "sim"), capture_output=True, text=True, timeout=30.0, check=False)
        assert second.returncode == 2
        assert second.stderr.count("\n") == 1
        assert second.stderr.startswith("error: Expected to listen on unixsock-stream/")
        assert asking.do(MISSION[3:]) == CRC
        assert first.poll() is None


@pytest.mark.parametrize("order", [("agent", "sim", "planner"), ("planner", "agent", "sim")], ids="-".join)
def test_processes_find_each_other_over_tcp_in_whatever_order_they_are_started(
    tmp_path: Path, order: tuple[Role, ...]
) -> None:
    locators = {role: f"tcp/127.0.0.1:{port}" for role, port in zip(order, free_ports(3), strict=True)}
    links: dict[str, list[str]] = {"agent": [locators["planner"], locators["sim"]], "sim": [], "planner": []}
    with ExitStack() as stack:
        for role in order:
            flags = ["--run", RUN, "--listen", locators[role], "--connect", *links[role]]
            started = stack.enter_context(running([*RUN_SCRIPT, role, *flags, "--journal", str(tmp_path / "j")]))
            assert started.stderr is not None
            assert "listening on" in started.stderr.readline()
            if role == "agent":
                asking = started
        out, err = asking.communicate(timeout=30.0)
    assert asking.returncode == 0, err
    assert out == f"{QUERY.seed} {CRC}\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_process_that_is_asked_to_stop_ends_well_and_leaves_nothing(tmp_path: Path, number: signal.Signals) -> None:
    with bus(tmp_path, "launcher") as watching, process(tmp_path, "sim") as started:
        assert eventually(lambda: watching.liveliness.live("sim") != [])
        started.send_signal(number)
        _, err = started.communicate(timeout=10.0)
        assert started.returncode == 0
        assert "Traceback" not in err
        assert not psutil.pid_exists(started.pid)
        assert list(tmp_path.glob("*.sock*")) == []


def test_an_agent_that_is_asked_to_stop_while_it_waits_ends_as_interrupted(tmp_path: Path) -> None:
    with bus(tmp_path, "launcher") as watching, process(tmp_path, "agent", "--journal", str(tmp_path / "j")) as started:
        assert eventually(lambda: watching.liveliness.live("agent") != [])
        started.send_signal(signal.SIGTERM)
        _, err = started.communicate(timeout=10.0)
        assert started.returncode == 130
        assert "Asked to stop while waiting for the answer to plan request 0; the planner is not there" in err
