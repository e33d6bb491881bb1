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

from legpush.files import new_file

PREFIX: Final = "legpush-"
"""How temporary folders are called in the temporary directory."""
OWNER_FILE: Final = ".owner"
"""A file that the owner of the folder keeps locked. The kernel unlocks it when the owner ends, however it ends."""


@contextmanager
def temporary_folder(kind: str = "") -> Iterator[Path]:
    """Make a folder of mode 0700, and remove it on exit; `clear_abandoned` removes it if this process is killed."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory(prefix=f"{PREFIX}{kind}", ignore_cleanup_errors=True)))
        with new_file(folder / OWNER_FILE) as scratch:
            owner = stack.enter_context(scratch.open("wb"))
            fcntl.flock(owner, fcntl.LOCK_EX)
        yield folder


def private_folders() -> list[Path]:
    """Return the folders with the usual prefix that only this user can enter."""
    with os.scandir(gettempdir()) as entries:
        return [Path(entry.path) for entry in entries if entry.name.startswith(PREFIX) and _is_private(entry)]


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
