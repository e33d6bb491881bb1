"""Machines as network namespaces: a hub with a cable to each of the others, which reach nothing but it."""

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Final

import pytest

from tests.system.missions import LIMIT_S

HUB: Final = {"robot": "10.117.1.1", "desk": "10.117.2.1"}
"""Addresses of the hub on its cables to the two other machines."""
NEEDS_ROOT: Final = pytest.mark.skipif(
    os.getuid() != 0 or shutil.which("ip") is None, reason="network namespaces need root and the program ip"
)


def space(name: str) -> str:
    """Return the name of the namespace of a machine."""
    return f"legpush-{name}-{os.getpid()}"


def ip(*arguments: str) -> None:
    """Run the program that configures networks."""
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
            plug(name, in_place=True)
            ip("-n", space(name), "link", "set", "hub", "up")
        yield
    finally:
        for name in ("hub", *HUB):
            subprocess.run(["ip", "netns", "del", space(name)], check=False)


def plug(name: str, *, in_place: bool) -> None:
    """Put the cable between the hub and a machine in its place, or pull it out."""
    ip("-n", space("hub"), "link", "set", name, "up" if in_place else "down")


def start(stack: ExitStack, log: Path, words: list[str]) -> "subprocess.Popen[bytes]":
    """Start a process whose output goes to the end of `log`; the stack kills it."""
    with log.open("ab") as output:
        process = subprocess.Popen(words, cwd=log.parent, stdout=output, stderr=subprocess.STDOUT)
    stack.callback(process.wait)
    stack.callback(process.kill)
    return process


def on(stack: ExitStack, host: str, log: Path, words: list[str]) -> "subprocess.Popen[bytes]":
    """Start a process on a machine."""
    return start(stack, log, ["ip", "netns", "exec", space(host), *words])


def said(log: Path, pattern: str) -> bool:
    """Whether a process says this in time."""
    until = monotonic() + LIMIT_S
    while re.search(pattern, log.read_text(), re.MULTILINE) is None:
        if monotonic() > until:
            return False
        sleep(0.02)
    return True
