"""The faults within a process: they come to the role of the cell alone, and only while they are switched on."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from legpush.soak.in_child import CELL_FILE, ENVIRONMENT, JUMP_S, SWITCH, lead_through_proxies, prepare, target_path

AGENT = ("python", "-P", "-m", "agent_proc", "--run", "x")
HOOK = Path("shared/legpush/soak/hook").resolve()


def cell(folder: Path, kind: str, role: str) -> Path:
    (folder / CELL_FILE).write_text(json.dumps({"kind": kind, "role": role}))
    return folder


def test_the_links_of_an_agent_lead_through_proxies_whose_target_is_kept(tmp_path: Path) -> None:
    connect = ["--connect", "unixsock-stream//tmp/legpush-x/planner.sock", "unixsock-stream//tmp/legpush-x/sim.sock"]
    argv = ["agent", "--listen", "unixsock-stream//tmp/legpush-x/agent.sock", *connect]
    lead_through_proxies(tmp_path, argv)
    proxies = [f"unixsock-stream/{tmp_path}/planner.proxy", f"unixsock-stream/{tmp_path}/sim.proxy"]
    assert argv == ["agent", "--listen", "unixsock-stream//tmp/legpush-x/agent.sock", "--connect", *proxies]
    assert target_path(tmp_path, "sim").readlink() == Path("/tmp/legpush-x/sim.sock")


@pytest.mark.parametrize("words", [("python", "-m", "agent_proc"), ("python", "-P", "-m", "starter", "agent_proc")])
def test_an_agent_is_found_by_its_module_and_by_one_that_starts_it(tmp_path: Path, words: tuple[str, ...]) -> None:
    argv = ["--connect", "unixsock-stream//tmp/legpush-x/sim.sock"]
    prepare(cell(tmp_path, "cut", "agent"), argv, words)
    assert argv == ["--connect", f"unixsock-stream/{tmp_path}/sim.proxy"]


@pytest.mark.parametrize("words", [("python", "-m", "sim_proc"), ("python", "-c", "agent_proc"), ("legpush", "run")])
def test_other_processes_stay_as_they_are(tmp_path: Path, words: tuple[str, ...]) -> None:
    argv = ["--connect", "unixsock-stream//tmp/legpush-x/sim.sock"]
    prepare(cell(tmp_path, "cut", "agent"), argv, words)
    assert argv == ["--connect", "unixsock-stream//tmp/legpush-x/sim.sock"]


def say(folder: Path, program: str) -> subprocess.CompletedProcess[str]:
    """Run a program as an agent that has the hook."""
    (folder / "agent_proc.py").write_text(program)
    paths = f"{HOOK}:{folder}:{Path('shared').resolve()}"
    environment = {"PYTHONPATH": paths, ENVIRONMENT: str(folder), "PATH": ""}
    return subprocess.run(
        [sys.executable, "-m", "agent_proc"], env=environment, cwd=folder, capture_output=True, text=True, check=False
    )


CLOCK = f"""
import time
from pathlib import Path
wall_s, mono_s = time.time(), time.monotonic()
Path({SWITCH!r}).touch()
print(round((time.time() - wall_s) / 60), round((time.time_ns() / 1e9 - wall_s) / 60))
print(round((time.monotonic() - mono_s) / 60))
"""


@pytest.mark.parametrize(("kind", "sign"), [("clock_ahead", 1), ("clock_back", -1)])
def test_the_clock_on_the_wall_jumps_and_the_monotonic_one_does_not(tmp_path: Path, kind: str, sign: int) -> None:
    jumped = round(sign * JUMP_S / 60)
    assert say(cell(tmp_path, kind, "agent"), CLOCK).stdout.split() == [str(jumped), str(jumped), "0"]


def test_the_hook_leaves_the_process_of_another_role_alone(tmp_path: Path) -> None:
    assert say(cell(tmp_path, "clock_back", "sim"), CLOCK).stdout.split() == ["0", "0", "0"]


DISK = f"""
import os, sys, time
from pathlib import Path
file, log = open("journal", "ab", buffering=0), open("read", "wb")
file.write(b"before")
Path({SWITCH!r}).touch()
while not os.path.samefile(f"/proc/self/fd/{{file.fileno()}}", "/dev/full"):
    time.sleep(0.001)
try:
    file.write(b"after")
except OSError as error:
    print(error.errno)
os.fdatasync(file.fileno())
print("synced")
"""


def test_a_full_disk_takes_nothing_more(tmp_path: Path) -> None:
    done = say(cell(tmp_path, "disk_full", "agent"), DISK)
    assert done.stdout.split() == ["28", "synced"], done.stderr
    assert (tmp_path / "journal").read_bytes() == b"before"


MESSAGES = f"""
from pathlib import Path
from legpush.bus.session import ZenohSession
from legpush.bus.endpoints import Endpoints
import legpush.bus.session as s
sent = []
class Publisher:
    def put(self, payload, attachment): sent.append(payload)
    def undeclare(self): pass
session = ZenohSession.__new__(ZenohSession)
session._session = type("S", (), {{"declare_publisher": lambda self, *a, **k: Publisher()}})()
for quality in ("lockstep", "tap"):
    sender = session.publisher("a/b", quality)
    for on in (False, True):
        Path({SWITCH!r}).touch() if on else Path({SWITCH!r}).unlink(missing_ok=True)
        sent.clear()
        for number in range(100):
            sender.send(b"%d" % number)
        numbers = [int(each) for each in sent]
        print(len(numbers), len(set(numbers)), int(numbers == sorted(numbers)))
import os, sys
sys.stdout.flush()
os._exit(0)
"""
SOUND = [100, 100, 1]


@pytest.mark.parametrize("kind", ["drop", "duplicate", "reorder"])
def test_messages_of_the_lockstep_are_spoilt_while_it_is_switched_on(tmp_path: Path, kind: str) -> None:
    done = say(cell(tmp_path, kind, "agent"), MESSAGES)
    rows = [[int(word) for word in line.split()] for line in done.stdout.splitlines()]
    off, on, *tap = rows
    assert off == SOUND, done.stderr
    assert tap == [SOUND, SOUND]
    assert {
        "drop": on[0] == on[1] < 80 and on[2] == 1,
        "duplicate": on[0] > 120 and on[1] == 100,
        "reorder": on[2] == 0 and on[1] >= 99,
    }[kind], on
