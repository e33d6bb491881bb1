"""Missions through a router: over three machines that reach only the router, and with a router that dies."""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Final

import pytest

from tests.ports import free_ports
from tests.security.hosts import made
from tests.system.conftest import RecordedMission
from tests.system.missions import LEGPUSH, LIMIT_S, crc_of

HUB: Final = {"robot": "10.117.1.1", "desk": "10.117.2.1"}
"""Addresses of the router on its cables to the two other machines; neither of them reaches the other one."""


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test started."""
    with ExitStack() as stack:
        yield stack


def start(stack: ExitStack, log: Path, words: list[str]) -> "subprocess.Popen[bytes]":
    with log.open("ab") as output:
        process = subprocess.Popen(words, cwd=log.parent, stdout=output, stderr=subprocess.STDOUT)
    stack.callback(process.wait)
    stack.callback(process.kill)
    return process


def said(log: Path, pattern: str) -> bool:
    """Whether a process says this in time."""
    until = monotonic() + LIMIT_S
    while re.search(pattern, log.read_text()) is None:
        if monotonic() > until:
            return False
        sleep(0.02)
    return True


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


def space(name: str) -> str:
    """Return the name of the namespace of a machine."""
    return f"legpush-{name}-{os.getpid()}"


def ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True)


@contextmanager
def three_machines() -> Iterator[None]:
    """Make the namespaces, and remove them."""
    try:
        for name in ("hub", *HUB):
            ip("netns", "add", space(name))
            ip("-n", space(name), "link", "set", "lo", "up")
        for name, address in HUB.items():
            ip("link", "add", name, "netns", space("hub"), "type", "veth", "peer", "name", "hub", "netns", space(name))
            ip("-n", space("hub"), "addr", "add", f"{address}/24", "dev", name)
            ip("-n", space(name), "addr", "add", f"{address[:-1]}2/24", "dev", "hub")
            ip("-n", space("hub"), "link", "set", name, "up")
            ip("-n", space(name), "link", "set", "hub", "up")
        yield
    finally:
        for name in ("hub", *HUB):
            subprocess.run(["ip", "netns", "del", space(name)], check=False)


@pytest.mark.skipif(
    os.getuid() != 0 or shutil.which("ip") is None, reason="network namespaces need root and the program ip"
)
def test_a_mission_over_three_machines_and_a_router_has_the_states_of_one_machine(
    push_mission: RecordedMission, stack: ExitStack, tmp_path: Path
) -> None:
    lab = made(tmp_path / "lab", f"hub={','.join(HUB.values())}", *HUB, routers=("hub",)).parent
    logs = {name: tmp_path / f"{name}.log" for name in ("router", "planner", "sim", "agent")}
    stack.enter_context(three_machines())

    def on(host: str, name: str, words: list[str]) -> "subprocess.Popen[bytes]":
        place = ["ip", "netns", "exec", space(host)]
        return start(stack, logs[name], [*place, *words, "--secure", str(lab / host)])

    port = 17470
    on("hub", "router", [*LEGPUSH, "router", "--listen", f"tls/0.0.0.0:{port}"])
    on("hub", "planner", python("planner", "--router", f"tls/127.0.0.1:{port}"))
    on("robot", "sim", python("sim", "--router", f"tls/{HUB['robot']}:{port}"))
    words = ("--scenario", "push", "--no-picture", "--out", str(tmp_path / "run"))
    agent = on("desk", "agent", python("agent", "--router", f"tls/{HUB['desk']}:{port}", *words))
    assert agent.wait(LIMIT_S) == 0, logs["agent"].read_text()
    assert crc_of(tmp_path / "run") == crc_of(push_mission.out)
    for name in ("planner.hub.1", "sim.robot.1", "agent.desk.1"):
        assert f"linked with {name} as router.hub.1" in logs["router"].read_text()
