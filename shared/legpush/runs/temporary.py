"""Temporary folders of this user that are cleared later if the process that made them was killed."""

import fcntl
import os
import shutil
import stat
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from typing import Final

from legpush.bus.endpoints import MAX_SOCKET_PATH_BYTES
from legpush.files import new_file

PREFIX: Final = "legpush-"
"""How temporary folders are called in the temporary directory."""
OWNER_FILE: Final = ".owner"
"""A file that the owner of the folder keeps locked. The kernel unlocks it when the owner ends, however it ends."""
SHORT: Final = "/tmp"  # noqa: S108 - only the parent of a directory that is made for one run
"""Where the sockets are if `TMPDIR` is too long for them."""
SPARE_BYTES: Final = len("/legpush-12345678/planner.sock") + 2
"""Room for a directory of sockets and the longest name of one, behind a temporary directory."""
NO_ENDPOINT: Final = frozenset("?#")
"""Characters that begin the parameters of an endpoint."""


@contextmanager
def temporary_folder(kind: str = "", parent: str | None = None) -> Iterator[Path]:
    """Make a folder of mode 0700, and remove it on exit; `clear_abandoned` removes it if this process is killed.

    It lies in `parent`, or else in the temporary directory of the user.
    """
    with ExitStack() as stack:
        made = TemporaryDirectory(prefix=f"{PREFIX}{kind}", dir=parent, ignore_cleanup_errors=True)
        folder = Path(stack.enter_context(made))
        with new_file(folder / OWNER_FILE) as scratch:
            owner = stack.enter_context(scratch.open("wb"))
            fcntl.flock(owner, fcntl.LOCK_EX)
        yield folder


def private_folders() -> list[Path]:
    """Return the folders with the usual prefix that only this user can enter."""
    folders: list[Path] = []
    for place in dict.fromkeys((gettempdir(), socket_place())):
        with os.scandir(place) as entries:
            folders += [Path(entry.path) for entry in entries if entry.name.startswith(PREFIX) and _is_private(entry)]
    return folders


def socket_place() -> str:
    """Return the temporary directory, or `/tmp` if a socket in that directory had too long a path.

    The path of a unix socket is short, and an endpoint of Zenoh has no place for some characters.
    """
    temporary = gettempdir()
    n_bytes = len(os.fsencode(temporary)) + SPARE_BYTES
    fits = n_bytes <= MAX_SOCKET_PATH_BYTES and temporary.isprintable() and not NO_ENDPOINT.intersection(temporary)
    return temporary if fits else SHORT


def clear_abandoned(before: Callable[[Path], None] = lambda folder: None) -> None:
    """Remove the folders whose owners are gone, each after a call of `before` with it.

    A folder without an owner file is none of legpush, or of an owner that begins just now, and is left alone.
    """
    for folder in private_folders():
        try:
            descriptor = os.open(folder / OWNER_FILE, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        except OSError:
            continue
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            continue
        else:
            before(folder)
            shutil.rmtree(folder, ignore_errors=True)
        finally:
            os.close(descriptor)


def _is_private(entry: os.DirEntry[str]) -> bool:
    """Return whether it is a directory, no link to one, that only this user can enter."""
    try:
        status = entry.stat(follow_symlinks=False)
    except OSError:
        return False
    return stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid() and stat.S_IMODE(status.st_mode) & 0o077 == 0
