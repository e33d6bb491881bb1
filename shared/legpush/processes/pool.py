"""A pool of simulators or planners: started together, each started again when it dies, ended together."""

import logging
import os
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from time import monotonic
from types import TracebackType
from typing import Final, Literal, Self

from legpush.bus.endpoints import Endpoints, in_directory, in_pool
from legpush.errors import ConfigError, PeerError
from legpush.files import make_folder
from legpush.patience import SLICE_S
from legpush.processes.child import Command, Process, describe_exit
from legpush.processes.crew import Crew, Interrupt
from legpush.processes.environment import RECORDED, child_environment
from legpush.processes.recorder_process import INCOMPLETE, recorder_arguments, what_is_missing
from legpush.runs.folder import run_name
from legpush.runs.live_runs import LiveRun, clear_killed_runs, shown, socket_directory

log = logging.getLogger(__name__)

MAX_RESTARTS: Final = 3
"""Most restarts of a process, in a row."""
WORDS: Final = {"sim": "simulator", "planner": "planner"}
"""What people call them."""
LONG_LIFE_S: Final = 10.0
"""A process that ran for this long before it died starts counting its restarts from zero."""


class SimPool:
    """A context manager that keeps `n` simulators running, named sim0, sim1 and so on; none is left on exit. With
    another role, processes of that kind.

    They connect to `endpoints`, which the bus of the agent has to listen on, and each listens on a socket of its own,
    for recorders and viewers; nobody but the user can reach them. `find_live_runs` finds the pool. Where a
    simulator cannot be kept running, `stop` is set, so that nobody goes on waiting for it, and leaving the context
    raises a `PeerError` with its last words.
    """

    def __init__(
        self,
        n: int,
        logs: Path,
        stop: threading.Event,
        *,
        kind: str = "simulators",
        folder: Path | None = None,
        role: Literal["sim", "planner"] = "sim",
        program: tuple[str, ...] | None = None,
        record: Path | None = None,
    ) -> None:
        """`logs` is the folder for what the simulators write; it is made if needed.

        `kind` is what others are told about the pool, such as `train`, and `folder` what it works for, which names its
        run. `program` is what Python runs as one, with its flags; the process of this package if not given.
        With `record`, what they and the agent say is recorded into that new file.
        """
        if n < 1:
            raise ConfigError(f"Expected at least 1 {WORDS[role]} to start, got {n}")
        self.run = run_name(folder or Path(f"{kind}-{os.getpid()}"))
        self._kind = kind
        self._folder = folder
        self._word = WORDS[role]
        self.names = tuple(f"{role}{index}" for index in range(n))
        self._logs = logs
        self._stop = stop
        self._program = ("-m", f"{role}_proc") if program is None else program
        self.record = record
        self._over = threading.Event()
        self._closing = ExitStack()

    def __enter__(self) -> Self:
        try:
            make_folder(self._logs, private=True)
        except OSError as error:
            raise ConfigError(
                f"Expected a folder that can be made for logs, got {self._logs} ({error.strerror})"
            ) from error
        for line in clear_killed_runs():
            log.warning("%s", line)
        directory = self._closing.enter_context(socket_directory())
        self.endpoints = Endpoints(listen=in_directory(directory, "agent").listen)
        self._at = {name: in_pool(directory, name) for name in self.names}
        connect = (*self.endpoints.listen, *(locator for at in self._at.values() for locator in at.listen))
        self._for_recorders = Endpoints(connect=connect)
        self._closing.enter_context(shown(LiveRun.now(self.run, self._kind, self._folder, connect), directory))
        # The kernel ends a child with the thread that started it: this one thread starts them all and stays.
        self._thread = self._closing.enter_context(ThreadPoolExecutor(1, thread_name_prefix="pool"))
        self._watch_over = self._thread.submit(self._watch)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._over.set()
        with self._closing:
            self._watch_over.result()

    def _watch(self) -> None:
        """Start all, start again who dies, and end all when the pool is over."""
        crew = Crew()
        recorder = None
        try:
            if self.record is not None:
                recorder = crew.start(self._recorder(self.record))
            posts = {name: _Post(crew.start(self._command(name)), self._word) for name in self.names}
            while not self._over.is_set():
                event = crew.next_event(SLICE_S)
                if event is None or isinstance(event, Interrupt):
                    continue
                if event is recorder:
                    log.warning("the recorder %s: %s", describe_exit(event.exit_code or 0), _last_line(event))
                else:
                    posts[event.role].refill(event, crew)
        except BaseException:
            self._stop.set()
            raise
        finally:
            crew.stop()
        if recorder is not None and recorder.exit_code not in (0, INCOMPLETE):
            log.warning("the recorder %s: %s", describe_exit(recorder.exit_code or 0), _last_line(recorder))
        for note in what_is_missing(recorder) if recorder is not None else ():
            log.warning("the recording is not complete: %s", note)

    def _recorder(self, file: Path) -> Command:
        return Command(
            role="recorder",
            argv=recorder_arguments(file, self.run, self._for_recorders),
            log=self._logs / "recorder.log",
            environment=child_environment(os.environ),
        )

    def _command(self, name: str) -> Command:
        at = self._at[name]
        flags = ("--run", self.run, "--name", name, "--listen", *at.listen, "--connect", *at.connect)
        if self.record is not None:
            flags += RECORDED
        return Command(
            role=name,
            # -P: what lies in the working directory is no part of the program.
            argv=(sys.executable, "-P", *self._program, *flags),
            log=self._logs / f"{name}.log",
            environment=child_environment(os.environ),
            flags_again=() if self.record is not None else RECORDED,
        )


def _last_line(process: Process) -> str:
    return " ".join(process.last_words(1)) or "it said nothing"


class _Post:
    """A process of the pool and how often it had to be started again."""

    def __init__(self, process: Process, word: str) -> None:
        self.process = process
        self._word = word
        self._started_at = monotonic()
        self._n_restarts = 0

    def refill(self, ended: Process, crew: Crew) -> None:
        """Start it again after it `ended`; `PeerError` after too many restarts."""
        if monotonic() - self._started_at >= LONG_LIFE_S:
            self._n_restarts = 0
        what = f"{self._word} {ended.role} {describe_exit(ended.exit_code or 0)}"
        if self._n_restarts >= MAX_RESTARTS:
            words = "".join(f"\n    {line}" for line in ended.last_words())
            raise PeerError(
                f"{what} and was started again {self._n_restarts} times in vain; the end of {ended.command.log}:{words}"
            )
        self._n_restarts += 1
        self._started_at = monotonic()
        self.process = crew.start(ended.command.again())
