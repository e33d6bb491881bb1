"""Planner, simulator and agent are started by hand, in every order: the mission ends in the same state."""

import signal
import subprocess
import sys
from contextlib import ExitStack
from itertools import permutations
from pathlib import Path

import pytest

from legpush.bus import endpoints
from legpush.messages.common import Role
from tests.system.missions import LIMIT_S, crc_of

ORDERS: list[tuple[Role, ...]] = list(permutations(("planner", "sim", "agent")))


def crc_in_order(folder: Path, order: tuple[Role, ...]) -> str:
    """State after the shortest mission, with the processes started one after the other."""
    folder.chmod(0o700)
    started: dict[Role, subprocess.Popen[str]] = {}
    with ExitStack() as stack:
        for role in order:
            at = endpoints.in_directory(folder, role)
            flags = ["--run", "order", "--listen", *at.listen]
            flags += ["--connect", *at.connect] if at.connect else []
            if role == "agent":
                flags += ["--scenario", "push", "--policy", "scripted", "--out", str(folder / "out")]
            process = subprocess.Popen(
                [sys.executable, "-X", "faulthandler", "-m", f"{role}_proc", *flags], stderr=subprocess.PIPE, text=True
            )
            stack.callback(process.kill)
            started[role] = process
            if role != "agent":
                wait_until_it_speaks(process)
        require_end(started["agent"], LIMIT_S)
        for role in ("planner", "sim"):
            started[role].send_signal(signal.SIGTERM)
            require_end(started[role], 30.0)
    return crc_of(folder / "out")


def require_end(process: subprocess.Popen[str], within_s: float) -> None:
    """It ends in time and well; one that hangs says where each of its threads is."""
    try:
        _, words = process.communicate(timeout=within_s)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGABRT)
        _, words = process.communicate(timeout=30.0)
        words += f"\nhung for {within_s:.0f} s"
    assert process.returncode == 0, words


def wait_until_it_speaks(process: subprocess.Popen[str]) -> None:
    """Its first log line: the process runs, so that the next one is started after it."""
    assert process.stderr is not None
    assert process.stderr.readline()


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> str:
    """State after the mission with the agent started last."""
    return crc_in_order(tmp_path_factory.mktemp("order"), ORDERS[0])


@pytest.mark.parametrize("order", ORDERS[1:], ids="-".join)
def test_the_order_in_which_the_processes_start_changes_nothing(
    order: tuple[Role, ...], expected: str, tmp_path: Path
) -> None:
    assert crc_in_order(tmp_path, order) == expected
