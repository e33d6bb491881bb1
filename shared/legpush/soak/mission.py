"""A whole mission in processes of its own, seen from outside: its phase, its processes, and what its launcher says."""

import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.resources import as_file, files
from pathlib import Path
from time import monotonic, sleep
from typing import Final, TypeVar

import psutil

from legpush.errors import JournalError, PeerError
from legpush.history.entries import Acted, Entry, Observed, Planned, Queried
from legpush.history.journal import Reading
from legpush.messages.stepping import Push, Walk
from legpush.soak.in_child import ENVIRONMENT
from legpush.soak.table import FaultRole, Phase

LEGPUSH: Final = (sys.executable, "-P", "-c", "import sys; from legpush.cli import main; sys.exit(main())")
"""The command as a user calls it."""
JOURNAL: Final = "episode-0000.journal"
RECORDING: Final = "mission.mcap"
LIMIT_S: Final = 180.0
"""Longest time that a disturbed mission may take on a busy machine."""
LOOK_S: Final = 0.002
T = TypeVar("T")


class JournalWatch:
    """Reads a journal that grows."""

    def __init__(self, path: Path) -> None:
        self.entries: list[Entry] = []
        self.n_answers = 0
        """Number of answers of simulator and planner among the entries."""
        self._path = path
        self._file: int | None = None
        self._reading: Reading | None = None

    def look(self) -> list[Entry]:
        """Read what is new, and return all entries."""
        if self._reading is None:
            try:
                self._file = os.open(self._path, os.O_RDONLY | os.O_CLOEXEC)
                self._reading = Reading(self._path, self._file)
            except (OSError, JournalError):
                return self.entries
        for entry in self._reading.entries():
            self.entries.append(entry)
            self.n_answers += isinstance(entry, Observed | Planned)
        return self.entries

    def phase(self) -> Phase | None:
        """Return the phase of the mission by its last question; None at its beginning."""
        entries = self.look()
        if entries and isinstance(entries[-1], Queried):
            return "planning"
        motion = next((entry.motion for entry in reversed(entries) if isinstance(entry, Acted)), None)
        return "walking" if isinstance(motion, Walk) else "pushing" if isinstance(motion, Push) else None

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            os.close(self._file)


class RunningMission:
    """A mission that goes on in the folder `out`."""

    def __init__(self, out: Path, *, seed: int = 0, faults: Path | None = None) -> None:
        """`faults` is the folder of a cell whose faults come from within the processes, or from their links."""
        self.out = out
        self.journal = JournalWatch(out / JOURNAL)
        self.lines: list[tuple[float, str]] = []
        """What the launcher said, each line with its monotonic time."""
        environment = dict(os.environ)
        if faults is not None:
            with as_file(files("legpush.soak") / "hook") as hook:
                paths = (str(hook), environment.get("PYTHONPATH", ""))
            environment |= {ENVIRONMENT: str(faults), "PYTHONPATH": os.pathsep.join(filter(None, paths))}
        self.launcher = subprocess.Popen(
            command(out, seed),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env=environment,
            start_new_session=True,  # Ctrl-C in the terminal is for the soak, which ends the mission
        )
        self._reader = threading.Thread(target=self._read, name="launcher", daemon=True)
        self._reader.start()

    def wait_for(self, phase: Phase) -> None:
        """Wait until the mission is in this phase.

        Raises:
            PeerError: It ends before.
        """
        self.wait(lambda: self.journal.phase() == phase, phase)

    def process(self, role: FaultRole, *others: int) -> psutil.Process:
        """Return the process of a role; wait for one that is none of the `others`."""

        def started() -> psutil.Process | None:
            for process in psutil.Process(self.launcher.pid).children(recursive=True):
                with suppress(psutil.Error):
                    if f"{role}_proc" in process.cmdline() and process.pid not in others:
                        return process
            return None

        return self.wait(started, f"a process {role}")

    def wait(self, look: Callable[[], T | None], what: str) -> T:
        """Look until there is something to see.

        Raises:
            PeerError: The mission ends before, or it takes too long.
        """
        until = monotonic() + LIMIT_S
        while not (seen := look()):
            if self.launcher.poll() is not None:
                raise PeerError(f"the mission ended before {what}:\n{self.said()}")
            if monotonic() > until:
                raise PeerError(f"waited more than {LIMIT_S:g} s for {what}:\n{self.said()}")
            sleep(LOOK_S)
        return seen

    def end(self) -> int:
        """Wait for the end of the mission, and return its exit code; one that takes too long is killed."""
        try:
            code = self.launcher.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            self.launcher.kill()
            code = self.launcher.wait()
        self._reader.join()
        return code

    def said(self) -> str:
        """Return what the launcher has said up to now."""
        return "\n".join(line for _, line in self.lines)

    def _read(self) -> None:
        if self.launcher.stdout is not None:
            for line in self.launcher.stdout:
                self.lines.append((monotonic(), line.rstrip("\n")))


def command(out: Path, seed: int) -> tuple[str, ...]:
    """Return the command of a mission in its folder; the same command goes on with it."""
    with as_file(files("legpush.soak") / "mission.toml") as scenario:
        flags = (str(scenario), "--seed", str(seed), "--policy", "scripted")
    number = sum(1 for _ in out.parent.glob(f"*{RECORDING}"))
    record = out.parent / f"{number}-{RECORDING}"
    return (*LEGPUSH, "run", *flags, "--no-video", "--no-picture", "--record", str(record), "--out", str(out))


@contextmanager
def running(out: Path, *, seed: int = 0, faults: Path | None = None) -> Iterator[RunningMission]:
    """A mission that is ended with the context."""
    mission = RunningMission(out, seed=seed, faults=faults)
    try:
        yield mission
    finally:
        if mission.launcher.poll() is None:
            for child in psutil.Process(mission.launcher.pid).children(recursive=True):
                with suppress(psutil.Error):  # a frozen one could not end
                    child.resume()
            mission.launcher.terminate()
        mission.end()
        mission.journal.close()
