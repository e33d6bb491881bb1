"""Scripts in the place of planner, simulator and agent, under a supervisor."""

import os
import signal
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from time import monotonic

import psutil

from legpush.launch.supervisor import Limits, Supervisor, Verdict
from legpush.messages.telemetry import Status
from legpush.processes.child import Command
from legpush.processes.crew import STOP_STAGES, Crew
from tests.legpush.launch.notebook import Notebook

SCRIPT = r"""
import os, pathlib, signal, subprocess, sys, time
role, folder, *orders = sys.argv[1], pathlib.Path(sys.argv[2]), *sys.argv[3:]

def is_there(name):
    while not (folder / name).exists():
        time.sleep(0.002)

lives = folder / f"{role}.lives"
life = len(lives.read_text().split()) if lives.exists() else 0
with lives.open("a") as file:
    print(os.getpid(), file=file)
print(f"life {life} of the {role}", flush=True)
signal.signal(signal.SIGINT, lambda *_: sys.exit(130))
for order in orders:
    verb, _, value = order.partition("=")
    if verb == "ready":
        (folder / role).touch()
    elif verb == "stubborn":
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
    elif verb == "tidy":
        signal.signal(signal.SIGINT, lambda *_: ((folder / "tidied").touch(), sys.exit(130)))
    elif verb == "child":
        child = subprocess.Popen([sys.executable, "-I", "-S", "-c", "import signal; signal.pause()"])
        with lives.open("a") as file:
            print(child.pid, file=file)
    elif verb == "await":
        is_there(value)
    elif verb == "freeze":
        (folder / f"{role}.freezes").touch()
        os.kill(os.getpid(), signal.SIGSTOP)
        (folder / f"{role}.thawed").touch()
    elif verb == "mark":
        (folder / value).touch()
    elif verb == "die":
        until_life, _, code = value.partition(":")
        if life < int(until_life):
            (folder / role).unlink(missing_ok=True)
            sys.exit(int(code))
    elif verb == "kill":
        if life < int(value):
            os.kill(os.getpid(), signal.SIGKILL)
    elif verb == "exit":
        sys.exit(int(value))
while True:
    signal.pause()
"""


def is_gone(pid: int) -> bool:
    """Whether a process ends within 20 s; one that only waits for its adopting process to reap it has ended."""
    until = monotonic() + 20.0
    while monotonic() < until:
        try:
            if psutil.Process(pid).status() == psutil.STATUS_ZOMBIE:
                return True
        except psutil.NoSuchProcess:
            return True
    return False


class Stage:
    """Runs the scripts under a supervisor: each role follows its orders, then waits for signals."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.display = Notebook()
        self.clock: Callable[[], float] = monotonic
        self.said: list[Status] = []
        self.has_result = True
        self._script = folder / "script.py"
        self._script.write_text(SCRIPT)

    def run(
        self,
        orders: dict[str, str],
        limits: Limits | None = None,
        stop_stages: Sequence[tuple[signal.Signals, float]] = STOP_STAGES,
    ) -> Verdict:
        commands = [
            Command(
                role=role,
                argv=(sys.executable, "-I", "-S", str(self._script), role, str(self.folder), *order.split()),
                log=self.folder / f"{role}.log",
                environment=os.environ,
            )
            for role, order in orders.items()
        ]
        with Crew(stop_stages) as crew:
            supervisor = Supervisor(
                crew,
                self.display,
                is_alive=lambda role: (self.folder / role).exists(),
                hear=self._hear,
                has_result=lambda: self.has_result,
                limits=limits,
                clock=self.clock,
            )
            verdict = supervisor.run(commands)
            assert crew.running() == ()
        return verdict

    def pids(self, role: str) -> list[int]:
        """Of every life of a role and of what it started."""
        path = self.folder / f"{role}.lives"
        return [int(pid) for pid in path.read_text().split()] if path.exists() else []

    def orphans(self) -> list[int]:
        """Processes that should have ended, but have not."""
        pids = [pid for path in self.folder.glob("*.lives") for pid in self.pids(path.stem)]
        assert pids, "no process ever started"
        return [pid for pid in pids if not is_gone(pid)]

    def _hear(self) -> Iterable[Status]:
        said, self.said = self.said, []
        return said
