"""What watches a run, joins it or is told by the environment, through a router: nothing else is linked with it."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from agent_proc.simulators import simulators
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, by_router
from legpush.bus.session import ZenohSession
from legpush.cli import command as cli
from legpush.errors import ConfigError, EndpointError
from legpush.history.run_history import RunHistory
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.messages.stepping import Reset, Walk
from legpush.options.learning import EvaluateOptions, SimulatorOptions
from legpush.recording.mcap_file.reader import read_recording
from legpush.scenarios.file import load_scenario
from sim_proc.view.sources import LiveSource
from tests.legpush.fakes import eventually
from tests.ports import free_ports
from tests.system.missions import LEGPUSH, LIMIT_S

RESET = Reset(scenario=load_scenario("push"), seed=1)


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test started."""
    with ExitStack() as stack:
        yield stack


@pytest.fixture
def router(stack: ExitStack) -> str:
    """Where a router listens."""
    at = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    stack.enter_context(closing(ZenohSession(Endpoints(listen=(at,), mode="router"), "router")))
    return at


def start(stack: ExitStack, words: list[str], **environment: str) -> "subprocess.Popen[str]":
    """Start a process that does not outlive the test."""
    process = subprocess.Popen(words, env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True)
    stack.callback(process.communicate)
    stack.callback(process.kill)
    return process


def stub_simulator(stack: ExitStack, router: str, name: str = "main", run: str = "local") -> None:
    """Start a simulator that is told of the router by its environment alone, and wait until it is there."""
    words = [sys.executable, "-P", "-m", "legpush.soak.stub_simulator", "--name", name]
    start(stack, words, LEGPUSH_ROUTER=router, LEGPUSH_RUN=run)
    assert cli.main(["health", "sim", "--name", name, "--run", run, "--router", router, "--wait", str(LIMIT_S)]) == 0


def step(router: str, n: int) -> None:
    """Be the agent of some steps."""
    with Bus("local", "agent", "main", by_router((router,))) as bus:
        world = BusWorld(SimLink(bus, "main", stop=threading.Event()))
        bus.announce()
        world.step(RESET)
        for _ in range(n):
            world.step(Walk())


def test_a_simulator_that_the_environment_sends_to_a_router_is_recorded_through_it(
    stack: ExitStack, router: str, tmp_path: Path
) -> None:
    stub_simulator(stack, router)
    recorder = start(stack, [*LEGPUSH, "record", str(tmp_path / "run.mcap"), "--router", router])
    assert cli.main(["health", "recorder", "--router", router, "--wait", str(LIMIT_S)]) == 0
    step(router, 5)
    recorder.send_signal(signal.SIGINT)
    said, _ = recorder.communicate(timeout=LIMIT_S)
    assert recorder.returncode == 0, said
    topics = [message.topic for message in read_recording([tmp_path / "run.mcap"]).messages]
    assert sum("observation" in topic for topic in topics) == 6
    assert sum("action" in topic for topic in topics) == 6


def test_a_view_shows_what_comes_through_a_router(stack: ExitStack, router: str) -> None:
    stub_simulator(stack, router)
    history = RunHistory()
    with LiveSource(None, (), routers=(router,)) as source:
        assert eventually(lambda: any(origin.role == "sim" for origin in source.live()))
        assert cli.main(["health", "viewer", "--router", router]) == 0
        step(router, 3)

        def n_steps() -> int:
            source.pump(history, 0.02)
            return sum(len(timeline.steps) for timeline in history.episodes.values())

        assert eventually(lambda: n_steps() >= 4)


def test_the_command_that_views_takes_a_router(stack: ExitStack, router: str) -> None:
    viewer = start(stack, [*LEGPUSH, "view", "--router", router, "--port", "0"])
    assert cli.main(["health", "viewer", "--router", router, "--wait", str(LIMIT_S)]) == 0
    viewer.send_signal(signal.SIGINT)
    said, _ = viewer.communicate(timeout=LIMIT_S)
    assert (viewer.returncode, said.startswith("Run local: http://127.0.0.1:")) == (0, True)


def test_simulators_are_joined_through_a_router(stack: ExitStack, router: str, tmp_path: Path) -> None:
    for name in ("a", "b"):
        stub_simulator(stack, router, name, run="training")
    options = SimulatorOptions(join="training", router=(router,), simulators=2)
    with simulators(options, tmp_path, threading.Event(), kind="test") as worlds:
        assert len(worlds) == 2
        first = [world.step(RESET).state_crc for world in worlds]
        assert [world.step(Walk()).world.tick for world in worlds] == [1, 1]
    assert first[0] == first[1]


def test_an_evaluation_joins_simulators_through_a_router(stack: ExitStack, router: str, tmp_path: Path) -> None:
    words = [sys.executable, "-P", "-m", "sim_proc", "--name", "only"]
    start(stack, words, LEGPUSH_ROUTER=router, LEGPUSH_RUN="shared")
    told = ["evaluate", "scripted", "--episodes", "1", "--simulators", "1", "--join", "shared", "--router", router]
    evaluation = start(stack, [*LEGPUSH, *told, "--out", str(tmp_path / "out")])
    said, _ = evaluation.communicate(timeout=LIMIT_S)
    assert evaluation.returncode == 0, said
    assert (tmp_path / "out" / "summary.json").exists()


@pytest.mark.parametrize("more", [{}, {"join": "run", "connect": ("tcp/a:1",)}])
def test_a_router_of_simulators_needs_a_run_and_no_other_endpoint(more: dict[str, object]) -> None:
    with pytest.raises((ConfigError, EndpointError), match=r"Expected (--join RUN with|either --router or)"):
        EvaluateOptions(policy="scripted", router=("tcp/b:2",), **more)  # type: ignore[arg-type]
