"""A mission whose planner and simulator are far away: 20 ms, 10 Mbit/s and 1 % loss each way change nothing in it."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from benchmarks.bus.slow_link import Link, SlowLink
from tests.ports import free_ports
from tests.system.conftest import RecordedMission
from tests.system.missions import LIMIT_S, crc_of


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test started."""
    with ExitStack() as stack:
        yield stack


def start(stack: ExitStack, role: str, *words: str) -> "subprocess.Popen[bytes]":
    process = subprocess.Popen([sys.executable, "-P", "-m", f"{role}_proc", *words])
    stack.callback(process.wait)
    stack.callback(process.kill)
    return process


def test_a_mission_over_links_with_delay_and_loss_has_the_states_of_one_machine(
    push_mission: RecordedMission, stack: ExitStack, tmp_path: Path
) -> None:
    link, connect = Link(delay_ms=20.0, mbit_s=10.0, loss=0.01), []
    for seed, role in enumerate(("planner", "sim")):
        near, far = free_ports(2)
        start(stack, role, "--listen", f"tcp/127.0.0.1:{far}")
        stack.enter_context(closing(SlowLink(link, near, far, seed)))
        connect.append(f"tcp/127.0.0.1:{near}")
    words = ("--listen", "--connect", *connect, "--scenario", "push", "--no-picture", "--out", str(tmp_path / "run"))
    assert start(stack, "agent", *words).wait(LIMIT_S) == 0
    assert crc_of(tmp_path / "run") == crc_of(push_mission.out)
