"""Missions through a router: over three machines that reach only the router, and with a router that dies."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.ports import free_ports
from tests.security.hosts import made
from tests.system.conftest import RecordedMission
from tests.system.machines import HUB, NEEDS_ROOT, on, said, start, three_machines
from tests.system.missions import LEGPUSH, LIMIT_S, crc_of


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test started."""
    with ExitStack() as stack:
        yield stack


def python(role: str, *words: str) -> list[str]:
    return [sys.executable, "-P", "-m", f"{role}_proc", *words]


def test_a_mission_goes_on_when_its_router_comes_back(
    push_mission: RecordedMission, stack: ExitStack, tmp_path: Path
) -> None:
    at = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    logs = {name: tmp_path / f"{name}.log" for name in ("router", "planner", "sim", "agent")}
    for role in ("planner", "sim"):
        start(stack, logs[role], python(role, "--router", at))
    words = python("agent", "--router", at, "--scenario", "push", "--no-picture", "--out", str(tmp_path / "run"))
    agent = start(stack, logs["agent"], words)
    routing = [*LEGPUSH, "router", "--listen", at]
    router = start(stack, logs["router"], routing)
    assert said(logs["agent"], "pushing: cycle 0"), logs["agent"].read_text()
    router.send_signal(signal.SIGKILL)
    assert said(logs["agent"], "the link to the router at .* is gone"), logs["agent"].read_text()
    start(stack, logs["router"], routing)
    assert agent.wait(LIMIT_S) == 0, logs["agent"].read_text()
    assert crc_of(tmp_path / "run") == crc_of(push_mission.out)


@NEEDS_ROOT
def test_a_mission_over_three_machines_and_a_router_has_the_states_of_one_machine(
    push_mission: RecordedMission, stack: ExitStack, tmp_path: Path
) -> None:
    lab = made(tmp_path / "lab", f"hub={','.join(HUB.values())}", *HUB, routers=("hub",)).parent
    logs = {name: tmp_path / f"{name}.log" for name in ("router", "planner", "sim", "agent")}
    stack.enter_context(three_machines())

    def run(host: str, name: str, words: list[str]) -> "subprocess.Popen[bytes]":
        return on(stack, host, logs[name], [*words, "--secure", str(lab / host)])

    port = 17470
    run("hub", "router", [*LEGPUSH, "router", "--listen", f"tls/0.0.0.0:{port}"])
    run("hub", "planner", python("planner", "--router", f"tls/127.0.0.1:{port}"))
    run("robot", "sim", python("sim", "--router", f"tls/{HUB['robot']}:{port}"))
    words = ("--scenario", "push", "--no-picture", "--out", str(tmp_path / "run"))
    agent = run("desk", "agent", python("agent", "--router", f"tls/{HUB['desk']}:{port}", *words))
    assert agent.wait(LIMIT_S) == 0, logs["agent"].read_text()
    assert crc_of(tmp_path / "run") == crc_of(push_mission.out)
    for name in ("planner.hub.1", "sim.robot.1", "agent.desk.1"):
        assert f"linked with {name} as router.hub.1" in logs["router"].read_text()
