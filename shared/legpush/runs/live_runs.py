"""The runs that launchers have going, as others on this machine find them: a file beside the sockets of each.

A launcher keeps the file locked for as long as its run lasts. The kernel unlocks it when the launcher ends, however it
ends, so a file that is not locked belongs to nobody.
"""

import fcntl
import os
import stat
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path
from time import time
from typing import Annotated, Final, Self

import msgspec
from msgspec import Meta, Struct

from legpush.bounds import Count
from legpush.bus.endpoints import require_locator
from legpush.errors import EndpointError, printable
from legpush.fields import Name
from legpush.files import new_file
from legpush.messages.common import PROTOCOL_VERSION
from legpush.runs.folder import COMMAND_FILE, LOGS
from legpush.runs.temporary import clear_abandoned, private_folders, socket_place, temporary_folder

RUN_FILE: Final = "run.json"
MAX_BYTES: Final = 65536
"""Largest file that is read; a larger one is not of a launcher."""
PRINTABLE: Final = r"^[^\x00-\x1f\x7f]+$(?!\n)"


class LiveRun(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A run that is going on."""

    protocol: Count
    run: Name
    """Its name on the bus."""
    kind: Annotated[str, Meta(pattern=PRINTABLE)]
    """Whose it is: the subcommand that launched it, such as `run` or `train`."""
    folder: Annotated[str, Meta(pattern=PRINTABLE)] | None
    """Absolute, None where the run leaves no folder behind."""
    pid: Count
    """Of the launcher."""
    began_unix_s: float
    connect: Annotated[tuple[str, ...], Meta(min_length=1)]
    """Where its processes listen, for those who watch."""

    def __str__(self) -> str:
        """`20261126-091500-default-seed0 (run, in /home/me/runs/20261126-091500-default-seed0)`."""
        where = f", in {self.folder}" if self.folder is not None else ""
        return f"{self.run} ({self.kind}{where})"

    @classmethod
    def now(cls, run: str, kind: str, folder: Path | None, connect: Sequence[str]) -> Self:
        """A run that this process launches now."""
        return cls(
            protocol=PROTOCOL_VERSION,
            run=run,
            kind=kind,
            folder=None if folder is None else str(folder.absolute()),
            pid=os.getpid(),
            began_unix_s=time(),
            connect=tuple(connect),
        )


def socket_directory() -> AbstractContextManager[Path]:
    """A directory of mode 0700 for the sockets of a run, where `find_live_runs` looks."""
    return temporary_folder(parent=socket_place())


def clear_killed_runs() -> list[str]:
    """Remove the temporary folders of killed launchers; return a line for each run of them that can go on."""
    lines: list[str] = []

    def note(folder: Path) -> None:
        run = _read(folder / RUN_FILE, locked=False)
        if run is None or run.folder is None:
            return
        try:
            command = (Path(run.folder) / LOGS / COMMAND_FILE).read_text(encoding="utf-8", errors="replace").strip()
        except OSError:
            return
        lines.append(printable(f"`legpush {run.kind}` in {run.folder} was killed; to go on: {command}"))

    clear_abandoned(note)
    return lines


@contextmanager
def shown(run: LiveRun, directory: Path) -> Iterator[None]:
    """Let others find this run by its directory of sockets, until the context is left or this process ends."""
    path = directory / RUN_FILE
    with ExitStack() as until_the_end:
        with new_file(path) as scratch:
            file = until_the_end.enter_context(scratch.open("wb"))
            fcntl.flock(file, fcntl.LOCK_EX)
            file.write(msgspec.json.encode(run))
            file.flush()
        try:
            yield
        finally:
            path.unlink(missing_ok=True)


def find_live_runs() -> tuple[LiveRun, ...]:
    """The runs of this user that launchers with the same temporary directory (`TMPDIR`) have going, oldest first.

    What others put there, what cannot be read, another protocol's and what a killed launcher left behind is skipped.
    """
    runs = (_read(directory / RUN_FILE) for directory in private_folders())
    return tuple(sorted((run for run in runs if run is not None), key=lambda run: (run.began_unix_s, run.run)))


def _read(path: Path, *, locked: bool = True) -> LiveRun | None:
    """The run in a file, None where it is none that lives; with `locked` False, none that does not live any more."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except OSError:
        return None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode) or status.st_size > MAX_BYTES or _is_locked(descriptor) is not locked:
            return None
        run = msgspec.json.decode(os.read(descriptor, MAX_BYTES), type=LiveRun)
        for locator in run.connect:
            require_locator(locator)
    except (OSError, UnicodeDecodeError, msgspec.MsgspecError, EndpointError):
        return None
    finally:
        os.close(descriptor)
    return run if run.protocol == PROTOCOL_VERSION else None


def _is_locked(descriptor: int) -> bool:
    """Whether somebody keeps the file locked."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    return False
