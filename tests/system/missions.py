"""`legpush run` as tests start it, and what a mission leaves behind."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Any, Final, Literal, TypeVar

import psutil
from filelock import FileLock

from legpush.history.entries import Acted, Queried
from legpush.history.journal import read_entries
from legpush.messages.common import Role
from legpush.messages.stepping import Push, Walk

LEGPUSH: Final = [sys.executable, "-P", "-c", "import sys; from legpush.cli import main; sys.exit(main())"]
"""The command as a user calls it."""
LIMIT_S: Final = 180.0
"""Longest time that any mission here takes on a busy machine."""
T = TypeVar("T")
Phase = Literal["planning", "walking", "pushing"]


def legpush(*words: str) -> subprocess.CompletedProcess[str]:
    """Run the command to its end."""
    return subprocess.run([*LEGPUSH, *words], capture_output=True, text=True, check=False, timeout=LIMIT_S)


def do_mission(out: Path, *flags: str) -> None:
    """Run a mission to its success."""
    done = legpush("run", "--no-video", "--out", str(out), *flags)
    assert done.returncode == 0, done.stdout + done.stderr


def report_of(out: Path) -> dict[str, Any]:
    """The report in the folder of a run."""
    report: dict[str, Any] = json.loads((out / "report.json").read_text())
    return report


def crc_of(out: Path) -> str:
    """CRC of the last state of a run."""
    crc: str = report_of(out)["state_crc"]
    return crc


def once(folder: Path, make: Callable[[Path], None]) -> Path:
    """The folder, after one process of this test run has made what is in it."""
    finished = folder / "finished"
    with FileLock(f"{folder}.lock", timeout=2 * LIMIT_S):
        if not finished.exists():
            # A process that failed in the middle of it may have left something.
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            make(folder)
            finished.touch()
    return folder


class RunningMission:
    """A mission that goes on, seen from outside."""

    def __init__(self, out: Path, *flags: str) -> None:
        self._out = out
        command = [*LEGPUSH, "run", "--no-video", "--out", str(out), *flags]
        self._launcher = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def wait_for(self, phase: Phase) -> None:
        """Wait until the mission is in this phase."""
        self._wait(lambda: self._is_in(phase), phase)

    def process(self, role: Role, *others: int) -> psutil.Process:
        """The process of a role; wait for one that is none of the `others`."""

        def started() -> psutil.Process | None:
            for process in psutil.Process(self._launcher.pid).children(recursive=True):
                with suppress(psutil.NoSuchProcess):
                    if f"{role}_proc" in process.cmdline() and process.pid not in others:
                        return process
            return None

        return self._wait(started, f"a process {role}")

    def output(self) -> str:
        """What the launcher said, after it has ended well."""
        output, _ = self._launcher.communicate(timeout=LIMIT_S)
        assert self._launcher.returncode == 0, output
        return output

    def end(self) -> None:
        """End it, if it still goes on."""
        if self._launcher.poll() is None:
            self._launcher.terminate()
            self._launcher.communicate(timeout=30.0)

    def _is_in(self, phase: Phase) -> bool:
        journal = self._out / "episode-0000.journal"
        entries = list(read_entries(journal)) if journal.exists() else []
        if len(entries) < 2:
            return False
        if phase == "planning":
            return isinstance(entries[-1], Queried)
        acted = [entry for entry in entries if isinstance(entry, Acted)]
        return bool(acted) and isinstance(acted[-1].motion, Walk if phase == "walking" else Push)

    def _wait(self, look: Callable[[], T | None], what: str) -> T:
        """Look until there is something to see; fail if the mission ends before, or after `LIMIT_S`."""
        pause, until = Event(), monotonic() + LIMIT_S
        while not (seen := look()):
            assert self._launcher.poll() is None, f"the run ended before {what}:\n{self._launcher.communicate()[0]}"
            assert monotonic() < until, f"waited too long for {what}"
            pause.wait(0.02)
        return seen


@contextmanager
def running_mission(out: Path, *flags: str) -> Iterator[RunningMission]:
    """A mission that is ended with the test."""
    mission = RunningMission(out, *flags)
    try:
        yield mission
    finally:
        mission.end()
