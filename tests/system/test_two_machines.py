"""The guide for two machines, word by word, in two network namespaces with a cable between them."""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Final, NamedTuple

import pytest

from docs.generate import DOCS
from legpush.recording.mcap_file.reader import read_recording
from legpush.runs.report import read_report
from tests.system.commands import LEGPUSH
from tests.system.missions import LIMIT_S

PAGE: Final = DOCS / "deploy.md"
SECTION: Final = "Two machines in five minutes"
MACHINES: Final = {"laptop": "192.168.1.10", "robot": "192.168.1.20"}
AGENT: Final = "python -m agent_proc"
IN_TERMINALS: Final = ("python -m sim_proc", "python -m planner_proc", "legpush record", AGENT, "legpush view")
"""Commands that go on while the next one is typed."""
PROGRAMS: Final = {"legpush": LEGPUSH, "python": f"{sys.executable} -P"}

pytestmark = pytest.mark.skipif(
    os.getuid() != 0 or shutil.which("ip") is None, reason="network namespaces need root and the program ip"
)


class Step(NamedTuple):
    """A command of the guide, and the machine on which it is typed."""

    machine: str
    command: str


def steps() -> list[Step]:
    """Return the commands of the section; each block is for the machine that the text names last."""
    text = PAGE.read_text().partition(f"## {SECTION}\n")[2].partition("\n## ")[0]
    machine, found = "laptop", list[Step]()
    for named, block in re.findall(r"\bOn `(\w+)`|^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        machine = named or machine
        found += [Step(machine, line) for line in block.splitlines()]
    return found


@contextmanager
def two_machines() -> Iterator[None]:
    """Make the namespaces, and remove them with all that runs in them."""
    try:
        for name in MACHINES:
            ip("netns", "add", space(name))
        peer = ("type", "veth", "peer", "name", "lp0", "netns", space("robot"))
        ip("link", "add", "lp0", "netns", space("laptop"), *peer)
        for name, address in MACHINES.items():
            ip("-n", space(name), "addr", "add", f"{address}/24", "dev", "lp0")
            for device in ("lo", "lp0"):
                ip("-n", space(name), "link", "set", device, "up")
        yield
    finally:
        for name in MACHINES:
            subprocess.run(["ip", "netns", "del", space(name)], check=False)


def space(name: str) -> str:
    """Return the name of the namespace of a machine."""
    return f"legpush-{name}-{os.getpid()}"


def ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True)


def words(step: Step, homes: Mapping[str, Path]) -> list[str]:
    """Return the command for its namespace; files are copied to another folder instead of another machine."""
    command = re.sub(r"^scp (.*) (\w+):(\S+)$", lambda m: f"cp {m[1]} {homes[m[2]]}/{m[3]}", step.command)
    program, _, rest = command.partition(" ")
    return ["ip", "netns", "exec", space(step.machine), "sh", "-c", f"exec {PROGRAMS.get(program, program)} {rest}"]


def test_the_guide_leads_from_no_certificate_to_a_recorded_mission_and_a_view_of_it(tmp_path: Path) -> None:
    homes = {name: tmp_path / name for name in MACHINES}
    logs: dict[str, Path] = {}
    with ExitStack() as stack:
        for home in homes.values():
            home.mkdir()
        stack.enter_context(two_machines())
        running: dict[str, subprocess.Popen[bytes]] = {}
        for step in steps():
            terminal = next((start for start in IN_TERMINALS if step.command.startswith(start)), None)
            if step.command.startswith("legpush info"):
                assert running[AGENT].wait(LIMIT_S) == 0, logs[AGENT].read_text()
                running["legpush record"].send_signal(signal.SIGINT)
                assert running["legpush record"].wait(LIMIT_S) == 0, logs["legpush record"].read_text()
            if terminal is None:
                done = run(words(step, homes), homes[step.machine])
                assert done.returncode == 0, (step, done.stdout, done.stderr)
                continue
            logs[terminal] = tmp_path / f"{terminal.split()[-1]}.log"
            output = stack.enter_context(logs[terminal].open("wb"))
            running[terminal] = subprocess.Popen(
                words(step, homes), cwd=homes[step.machine], stdout=output, stderr=subprocess.STDOUT
            )
            stack.callback(end, running[terminal])
            assert has_begun(logs[terminal]), (step, logs[terminal].read_text())
        assert running.keys() == set(IN_TERMINALS)
        page = re.search(r"http://\S+", logs["legpush view"].read_text())
        assert page is not None
        fetch = f"from urllib.request import *; print(build_opener(HTTPCookieProcessor()).open('{page[0]}').status)"
        shown = run(["ip", "netns", "exec", space("laptop"), sys.executable, "-c", fetch], tmp_path)
        assert shown.stdout == "200\n", shown.stderr
        assert "WARNING" not in logs["legpush view"].read_text()
    assert read_report(homes["laptop"] / "mission")["success"] is True
    assert read_recording([homes["laptop"] / "mission.mcap"]).completeness["complete"] == "yes"
    assert "linked with agent.laptop.1 as sim.robot.1" in logs["python -m sim_proc"].read_text()
    assert not list(homes["robot"].rglob("authority.key"))


def run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command to its end."""
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=LIMIT_S)


def has_begun(log: Path) -> bool:
    """Whether a process that does not end has said that it has begun."""
    until = monotonic() + LIMIT_S
    while re.search(r"taking part as|recording to|http://", log.read_text()) is None:
        if monotonic() > until:
            return False
        sleep(0.05)
    return True


def end(process: "subprocess.Popen[bytes]") -> None:
    process.kill()
    process.wait()
