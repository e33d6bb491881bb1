"""What training and evaluation have in common as programs: folder, signals, errors and simulators."""

import fcntl
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Final

from agent_proc.simulators.bus_world import BusWorld
from agent_proc.simulators.pools import joined_simulators, own_simulators
from legpush.bus.endpoints import Endpoints
from legpush.errors import ConfigError, LegpushError
from legpush.options.learning import SimulatorOptions
from legpush.service import one_line, start_log

LOGS: Final = "logs"


def run_program(work: Callable[[], int]) -> int:
    """The exit code of `work`; a `LegpushError` is one line on standard error."""
    start_log("learn", "warning")
    try:
        return work()
    except LegpushError as error:
        sys.stderr.write(f"error: {one_line(str(error))}\n")
        return error.exit_code


def simulators(
    options: SimulatorOptions, logs: Path, stop: threading.Event, *, kind: str, folder: Path | None = None
) -> AbstractContextManager[list[BusWorld]]:
    """Worlds of simulators that are started, or joined where the options say so.

    `kind` of work and its `folder` are what a recorder or viewer is told about those that are started.
    """
    if options.join is None:
        return own_simulators(options.n_simulators, logs, stop, record=options.record, kind=kind, folder=folder)
    endpoints = Endpoints(listen=options.listen, connect=options.connect)
    return joined_simulators(options.n_simulators, options.join, endpoints, stop)


@contextmanager
def own_folder(folder: Path) -> Iterator[None]:
    """Keep other programs out of the folder meanwhile; `ConfigError` where one is in it."""
    lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError as error:
        raise ConfigError(f"{folder}: expected a folder of its own, but another program is using it") from error
    finally:
        os.close(lock)
