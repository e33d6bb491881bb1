"""Makes a damaged journal usable again, before a mission goes on with it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from legpush.errors import JournalError
from legpush.history.entries import Opened
from legpush.history.journal import Reading, cut_at, read_whole
from legpush.history.journal_file import lock


def mend(path: Path) -> str | None:
    """Cut off what is torn at the end, keep the original, and return what was done; None if the journal is whole.

    Raises:
        JournalError: It is no journal, or it is damaged and has whole entries behind the damage.
        DiskFullError: There is no space for a copy of the original.
    """
    with _opened(path) as file:
        _, reading = read_whole(path, file)
        return None if reading.is_at_end() else cut_at(path, file, reading)


def step_back(path: Path) -> tuple[Opened, str]:
    """Cut a journal off at its first damage, whatever is behind that; return its first entry and what was done.

    Raises:
        JournalError: It is no journal, it is whole, or its first entry is damaged.
        DiskFullError: There is no space for a copy of the original.
    """
    with _opened(path) as file:
        reading = Reading(path, file)
        first: object = None
        for entry in reading.ordered():
            first = first or entry
        if not isinstance(first, Opened):
            raise JournalError(reading.damage())
        if reading.is_at_end():
            raise JournalError(f"{path}: expected a damaged journal, got a whole one: nothing to recover")
        return first, cut_at(path, file, reading)


@contextmanager
def _opened(path: Path) -> Iterator[int]:
    """Open a journal for one process at a time."""
    try:
        file = os.open(path, os.O_RDWR | os.O_CLOEXEC)
    except OSError as error:
        raise JournalError(f"Expected a journal that can be written, {path}: {error.strerror}") from error
    try:
        lock(path, file)
        yield file
    finally:
        os.close(file)
