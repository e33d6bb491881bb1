"""One child process in a group of its own: started, watched, and ended together with everything it started."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import psutil

from legpush.files import private_opener
from legpush.processes import parent_watch

TAIL_LINES: Final = 12
TAIL_BYTES: Final = 8192
"""Number of bytes at the end of a log that are read first; more are read if they have too few lines."""


@dataclass(frozen=True, kw_only=True)
class Command:
    """How to start a process, and where its output goes."""

    role: str
    """Its name, for messages to people."""
    argv: tuple[str, ...]
    """The program's absolute path, then its arguments."""
    log: Path
    """Standard output and standard error are appended here."""
    environment: Mapping[str, str]
    flags_again: tuple[str, ...] = ()
    """What is added to `argv` when it has to be started again."""

    def again(self) -> "Command":
        """How to start it when it has died."""
        return replace(self, argv=self.argv + self.flags_again, flags_again=())


class Process:
    """A running process group; its leader is the command's process.

    Start it on a thread that lives as long as it should: the kernel kills it when that thread ends.
    """

    def __init__(self, command: Command, on_exit: Callable[["Process"], None]) -> None:
        """`on_exit` is called on another thread once the whole group has ended and `exit_code` is known."""
        self.command = command
        self.role = command.role
        self.exit_code: int | None = None
        """Negative is the signal that ended it; None while it runs."""
        self._on_exit = on_exit
        self._reaping = threading.Lock()
        with open(command.log, "ab", opener=private_opener) as log:
            self._log_start = log.tell()
            self._child = subprocess.Popen(
                [sys.executable, "-I", "-S", parent_watch.__file__, str(os.getpid()), *command.argv],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env=dict(command.environment),
            )
        self.pid = self._child.pid
        threading.Thread(target=self._wait, name=f"wait for {self.role}", daemon=True).start()

    def signal(self, number: signal.Signals) -> None:
        """Send a signal to the whole group; nothing happens once it has ended."""
        with self._reaping:
            if self.exit_code is None:
                self._kill_group(number)

    def is_frozen(self) -> bool:
        """Whether it is stopped, by SIGSTOP or a debugger, and so can neither go on nor end."""
        try:
            return psutil.Process(self.pid).status() in (psutil.STATUS_STOPPED, psutil.STATUS_TRACING_STOP)
        except psutil.NoSuchProcess:
            return False

    def last_words(self, n_lines: int = TAIL_LINES) -> tuple[str, ...]:
        """The last lines that it wrote, without empty ones."""
        with self.command.log.open("rb") as log:
            begin = end = log.seek(0, os.SEEK_END)
            lines: list[str] = []
            while len(lines) <= n_lines and begin > self._log_start:
                begin = max(self._log_start, end - max(TAIL_BYTES, 2 * (end - begin)))
                log.seek(begin)
                said = log.read(end - begin).decode(errors="replace").splitlines()
                lines = [line.rstrip() for line in said if line.strip()]
        return tuple(lines[-n_lines:])

    def _wait(self) -> None:
        """Wait for the leader, end what it left behind, and only then let its number go to other processes."""
        os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOWAIT)
        with self._reaping:
            self._kill_group(signal.SIGKILL)
            self.exit_code = self._child.wait()
        self._on_exit(self)

    def _kill_group(self, number: int) -> None:
        """Signal the group; there is none if a signal to the launcher's own group ended the child too early.

        A child is in the launcher's group until it opens its own, and `Popen` does not notice if it dies there.
        """
        with suppress(ProcessLookupError):
            os.killpg(self.pid, number)


def describe_exit(exit_code: int) -> str:
    """`exited with 3`, `was killed by SIGKILL`."""
    if exit_code >= 0:
        return f"exited with {exit_code}"
    return f"was killed by {signal.Signals(-exit_code).name}"
