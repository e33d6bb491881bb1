"""The journal of an episode: everything that the agent asked and was answered, in order, on disk.

An action is written before it is sent, so that whatever happened to the world is in the file. Each entry is one write,
so a killed process leaves whole entries and at most one incomplete one at the end. What was written is synced to disk
once a second, so a power loss leaves an end that can be torn. A torn end is cut off when the journal is opened again.
"""

import errno
import logging
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Final, Self

from legpush.errors import DiskFullError, JournalError, MessageError, OtherVersionError
from legpush.files import new_file
from legpush.history.disk_sync import DiskSync
from legpush.history.entries import (
    Acted,
    AnyEntry,
    Awaited,
    Entry,
    Numbered,
    Observed,
    Opened,
    Planned,
    Queried,
    Refused,
)
from legpush.history.journal_file import MAGIC, cut, frame, is_incomplete, is_whole_after, lock, payloads
from legpush.messages import codec

log = logging.getLogger(__name__)

_FULL: Final = (errno.ENOSPC, errno.EDQUOT)


def read_entries(path: Path) -> Iterator[Entry]:
    """Yield all entries in order, the first an `Opened`; an incomplete last one is left out.

    Raises:
        JournalError: The file cannot be read, is no journal, or is damaged.
        OtherVersionError: An entry is whole, but of another version.
    """
    try:
        file = path.open("rb")
    except OSError as error:
        raise JournalError(f"Expected to read the journal {path}: {error.strerror}") from error
    with file:
        reading, tried = Reading(path, file.fileno()), 0
        # A frame that was incomplete a moment ago may be whole by now, since the journal may be written to meanwhile.
        while reading.end > tried:
            tried = reading.end
            yield from reading.entries()
            if is_incomplete(file.fileno(), reading.end):
                return
        raise JournalError(reading.damage())


class Reading:
    """Reads a journal entry by entry, up to its end or to the first entry that is damaged."""

    def __init__(self, path: Path, file: int) -> None:
        """Begin to read.

        Raises:
            JournalError: The file does not begin as a journal does.
        """
        self.end = len(MAGIC)
        """Position behind the last entry that was read."""
        self.n_entries = 0
        self.n_steps = 0
        """Number of actions that were carried out, in the entries that were read."""
        self._path = path
        self._file = file
        if os.pread(file, len(MAGIC), 0) != MAGIC:
            raise JournalError(f"{path} is not an episode journal")

    def entries(self) -> Iterator[Entry]:
        """Yield the entries that are whole.

        Raises:
            OtherVersionError: An entry is whole, but of another version.
        """
        for payload, end in payloads(self._file, self.end):
            try:
                entry = codec.decode(payload, AnyEntry).e
            except MessageError as error:
                raise OtherVersionError(
                    f"{self._path}: other version: entry {self.n_entries} cannot be read here ({error})"
                ) from error
            yield entry
            self._count(entry, end)

    def ordered(self) -> Iterator[Entry]:
        """Yield the entries up to the first that cannot follow those before it: each question has its own answer."""
        question: Entry | None = None
        for entry in self.entries():
            match entry:
                case Opened():
                    follows = self.n_entries == 0
                case Numbered():
                    follows = self.n_entries > 0
                case Acted() | Queried() | Awaited():
                    follows, question = self.n_entries > 0 and question is None, entry
                case Observed() | Refused():
                    follows, question = isinstance(question, Acted), None
                case Planned():
                    follows, question = isinstance(question, (Queried, Awaited)), None
            if not follows:
                return
            yield entry

    def is_at_end(self) -> bool:
        """Return whether the file has nothing behind the last entry that was read."""
        return self.end == os.fstat(self._file).st_size

    def is_torn(self) -> bool:
        """Return whether nothing behind the last entry that was read is whole, so that nothing is lost by a cut."""
        return next(payloads(self._file, self.end), None) is None and not is_whole_after(self._file, self.end)

    def damage(self) -> str:
        """Return what is damaged from here on, and how the entries before it can be used, for people."""
        where = f"{self._path}: entry {self.n_entries} at byte {self.end} is damaged"
        if self.n_entries == 0:
            return f"{where}, the first one: nothing in it can be used"
        return (
            f"{where} or out of order, so it cannot be read from step {self.n_steps} on; "
            f"`legpush recover {self._path.parent}` goes back to the steps before that"
        )

    def _count(self, entry: Entry, end: int) -> None:
        self.end = end
        self.n_entries += 1
        self.n_steps += isinstance(entry, Observed)


class Journal:
    """A journal that is open for appending, by one process at a time; a context manager."""

    def __init__(self, path: Path, opened: Opened) -> None:
        """Create the journal at `path`, or open the one that is there, which has to be of the same run.

        Raises:
            JournalError: It is another run's, damaged before its end, or in use.
            OtherVersionError: It is of another version of the protocol.
            DiskFullError: The disk is full.
        """
        self.path = path
        try:
            if not path.exists():
                _create(path, opened)
            self._file = os.open(path, os.O_RDWR | os.O_APPEND | os.O_CLOEXEC)
        except OSError as error:
            raise _cannot_write(path, error) from error
        try:
            lock(path, self._file)
            self.opened = self._check(opened)
        except BaseException:
            os.close(self._file)
            raise
        self._disk = DiskSync(self._file)

    def __enter__(self) -> Self:
        self._disk.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._disk.stop()
        os.close(self._file)

    def append(self, entry: Entry) -> None:
        """Write one entry; when this returns, a kill of this process cannot lose it.

        Raises:
            DiskFullError: The disk is full; the journal is as it was.
            JournalError: The journal cannot be written for another reason.
        """
        before = os.fstat(self._file).st_size
        left = frame(codec.encode(AnyEntry(e=entry)))
        try:
            self._disk.note_write()
            while left:
                left = left[os.write(self._file, left) :]
        except OSError as error:
            with suppress(OSError):
                os.ftruncate(self._file, before)
            raise _cannot_write(self.path, error) from error

    def _check(self, opened: Opened) -> Opened:
        """Return the first entry, after what is torn at the end was cut off."""
        first, reading = read_whole(self.path, self._file)
        if first.protocol != opened.protocol:
            raise OtherVersionError(
                f"{self.path}: other version: expected a journal of protocol version {opened.protocol}, got one of "
                f"{first.protocol}; {cannot_go_on(self.path.parent)}"
            )
        for field in ("run", "seed"):
            expected, got = getattr(opened, field), getattr(first, field)
            if expected != got:
                raise JournalError(f"{self.path}: expected a journal of {field} {expected}, got one of {got}")
        if not reading.is_at_end():
            log.warning("%s", cut_at(self.path, self._file, reading))
        return first


def cannot_go_on(folder: Path) -> str:
    """Return what can be done with the folder of a mission of another version, for people."""
    return f"the mission in {folder} cannot go on here: begin it again with another --out"


def read_whole(path: Path, file: int) -> tuple[Opened, Reading]:
    """Read a journal whose end may be torn, and return its first entry, and how far it is whole.

    Raises:
        JournalError: It is no journal, or it is damaged and has whole entries behind the damage.
    """
    first: Entry | None = None
    reading = Reading(path, file)
    for entry in reading.ordered():
        first = first or entry
    if not isinstance(first, Opened) or not (reading.is_at_end() or reading.is_torn()):
        raise JournalError(reading.damage())
    return first, reading


def cut_at(path: Path, file: int, reading: Reading) -> str:
    """Cut a journal off behind the last entry that was read, keep the original, and return what was done, for people.

    Raises:
        DiskFullError: There is no space for a copy of the original.
        JournalError: The copy cannot be made for another reason.
    """
    n_bytes = os.fstat(file).st_size - reading.end
    try:
        kept = cut(path, file, reading.end)
    except OSError as error:
        raise _cannot_write(path, error) from error
    return (
        f"{path}: the last {n_bytes} bytes were damaged and are cut off; it goes on from step {reading.n_steps}, and "
        f"the original is {kept.name}"
    )


def _create(path: Path, opened: Opened) -> None:
    """Put a new journal in place as a whole, so that every journal that is found has its first entry."""
    path.parent.mkdir(parents=True, exist_ok=True)
    # If another process makes the same journal at this moment, the lock decides between the two.
    with suppress(FileExistsError), new_file(path, private=True) as scratch:
        scratch.write_bytes(MAGIC + frame(codec.encode(AnyEntry(e=opened))))


def _cannot_write(path: Path, error: OSError) -> JournalError | DiskFullError:
    kind = DiskFullError if error.errno in _FULL else JournalError
    return kind(f"Expected to write the journal {path}: {error.strerror}")
