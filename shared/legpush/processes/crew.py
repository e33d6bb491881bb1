"""All child processes of a launcher, and the one queue in which their ends and the user's signals arrive."""

import queue
import signal
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from time import monotonic
from types import FrameType, TracebackType
from typing import Final, Self

from legpush.processes.child import Command, Process

STOP_STAGES: Final = ((signal.SIGINT, 5.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 5.0))
"""What a process that has to end is sent, and how many seconds it has before the next one."""


@dataclass(frozen=True)
class Interrupt:
    """A signal that asks the launcher to end."""

    by: signal.Signals


Event = Process | Interrupt
"""A process that ended, or a signal to the launcher."""


class Crew:
    """A context manager: no process and no signal handler of it is left on exit. Use it on the main thread.

    On another thread, without entering it, it handles no signals, and `stop` has to be called at the end.
    """

    def __init__(self, stop_stages: Sequence[tuple[signal.Signals, float]] = STOP_STAGES) -> None:
        self._stop_stages = stop_stages
        self._events: queue.SimpleQueue[Event] = queue.SimpleQueue()
        self._processes: list[Process] = []
        self._restore: list[Callable[[], object]] = []

    def __enter__(self) -> Self:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            before = signal.signal(number, self._interrupt)
            self._restore.append(partial(signal.signal, number, before))
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        try:
            self.stop()
        finally:
            for restore in self._restore:
                restore()

    def start(self, command: Command) -> Process:
        """Start a process; its end is an event."""
        process = Process(command, self._events.put)
        self._processes.append(process)
        return process

    def next_event(self, timeout_s: float) -> Event | None:
        """The next process that ended or signal that came, None if there is none within `timeout_s`."""
        try:
            return self._events.get(timeout=timeout_s)
        except queue.Empty:
            return None

    def running(self) -> tuple[Process, ...]:
        """Those that have not ended."""
        return tuple(process for process in self._processes if process.exit_code is None)

    def stop(self) -> None:
        """End all processes: ask, demand, kill, each for a bounded time; a signal to the launcher skips a stage."""
        for number, patience_s in self._stop_stages:
            for process in self.running():
                process.signal(number)
                process.signal(signal.SIGCONT)
            until = monotonic() + patience_s
            while self.running() and (left_s := until - monotonic()) > 0.0:
                if isinstance(self.next_event(left_s), Interrupt):
                    break
        self._processes = list(self.running())

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        """The signal handler: a `SimpleQueue` may be put to in the middle of anything."""
        self._events.put(Interrupt(signal.Signals(number)))
