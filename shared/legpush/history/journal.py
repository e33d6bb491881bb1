"""The journal of an episode: everything that the agent asked and was answered, in order, on disk.

An action is written before it is sent, so that whatever happened to the world is in the file. The file is a magic
number and then frames: length and its CRC-32, an entry as MessagePack, the entry's CRC-32. Each entry is one write, so
a killed process leaves whole entries and at most one incomplete one at the end, which is dropped.
"""

import fcntl
import logging
import os
import struct
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Final, Self
from zlib import crc32

from msgspec import Struct

from legpush.errors import JournalError, MessageError
from legpush.fields import Name
from legpush.files import new_file
from legpush.messages import codec
from legpush.messages.common import Count
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome

log = logging.getLogger(__name__)

JOURNAL_VERSION: Final = 2
MAGIC: Final = b"legpush journal\n"
_HEAD: Final = struct.Struct(">II")
_TAIL: Final = struct.Struct(">I")


class Opened(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="opened"):
    """The first entry: which episode of which run this is."""

    journal_version: int = JOURNAL_VERSION
    protocol: int
    run: Name
    seed: Count
    versions: dict[str, str]
    """Package to version, of the agent that began the episode."""
    began_unix_s: float


class Numbered(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="numbered"):
    """From here on the simulator knows the episode by this number."""

    episode: Count


class Acted(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="acted"):
    """An action that is about to be sent."""

    motion: Motion
    with_trace: bool


class Observed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="observed"):
    """What the action before led to."""

    outcome: Outcome


class Refused(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="refused"):
    """The action before cannot be carried out; the state is as it was."""

    reason: str


class Queried(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="queried"):
    """A plan query that is about to be sent."""

    query: PlanQuery


class Awaited(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="awaited"):
    """A better plan for the last query is waited for."""

    revision: Count


class Planned(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="planned"):
    """The plan that answers the query before, or the better one that was waited for."""

    plan: Plan


Entry = Opened | Numbered | Acted | Observed | Refused | Queried | Awaited | Planned


class _AnyEntry(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What one frame holds."""

    e: Entry


def read_entries(path: Path) -> Iterator[Entry]:
    """All entries in order, the first an `Opened`; an incomplete last one is left out.

    `JournalError` for a file that cannot be read, is no journal, is damaged, or is of another version.
    """
    try:
        file = path.open("rb")
    except OSError as error:
        raise JournalError(f"Expected to read the journal {path}: {error.strerror}") from error
    with file:
        for entry, _ in _scan(path, file.fileno()):
            yield entry


class Journal:
    """A journal that is open for appending, by one process at a time; a context manager."""

    def __init__(self, path: Path, opened: Opened) -> None:
        """Create the journal at `path`, or open the one that is there, which has to be of the same run.

        `JournalError` if it is another run's, damaged, or in use.
        """
        self.path = path
        try:
            if not path.exists():
                _create(path, opened)
            self._file = os.open(path, os.O_RDWR | os.O_APPEND | os.O_CLOEXEC)
        except OSError as error:
            raise JournalError(f"Expected to write the journal {path}: {error.strerror}") from error
        try:
            self._lock()
            self.opened = self._check(opened)
        except BaseException:
            os.close(self._file)
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        os.close(self._file)

    def append(self, entry: Entry) -> None:
        """Write one entry; when this returns, a kill of this process cannot lose it."""
        frame = _frame(entry)
        try:
            while frame:
                frame = frame[os.write(self._file, frame) :]
        except OSError as error:
            raise JournalError(f"Expected to write the journal {self.path}: {error.strerror}") from error

    def _lock(self) -> None:
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise JournalError(f"{self.path} is in use by another process") from error

    def _check(self, opened: Opened) -> Opened:
        """The first entry; drops an incomplete last one from the file."""
        first: Entry | None = None
        end = len(MAGIC)
        for entry, position in _scan(self.path, self._file):
            first, end = first or entry, position
        if not isinstance(first, Opened):
            raise JournalError(f"{self.path}: expected the entry `opened` first, got {type(first).__name__.lower()}")
        for field in ("protocol", "run", "seed"):
            expected, got = getattr(opened, field), getattr(first, field)
            if expected != got:
                raise JournalError(f"{self.path}: expected a journal of {field} {expected}, got one of {got}")
        size = os.fstat(self._file).st_size
        if size > end:
            log.warning("%s: dropped an incomplete last entry of %d bytes", self.path, size - end)
            os.ftruncate(self._file, end)
        return first


def _create(path: Path, opened: Opened) -> None:
    """Put a new journal in place as a whole, so that every journal that is found has its first entry."""
    path.parent.mkdir(parents=True, exist_ok=True)
    # If another process makes the same journal at this moment, the lock decides between the two.
    with suppress(FileExistsError), new_file(path) as scratch:
        scratch.write_bytes(MAGIC + _frame(opened))


def _frame(entry: Entry) -> bytes:
    payload = codec.encode(_AnyEntry(e=entry))
    length = struct.pack(">I", len(payload))
    return length + _TAIL.pack(crc32(length)) + payload + _TAIL.pack(crc32(payload))


def _scan(path: Path, file: int) -> Iterator[tuple[Entry, int]]:
    """Each complete entry with the position at which it ends."""
    if os.pread(file, len(MAGIC), 0) != MAGIC:
        raise JournalError(f"{path} is not an episode journal")
    position, index = len(MAGIC), 0
    while len(head := os.pread(file, _HEAD.size, position)) == _HEAD.size:
        length, crc = _HEAD.unpack(head)
        if crc32(head[:4]) != crc:
            raise JournalError(f"{path}: entry {index} at byte {position} is damaged")
        body = _read(file, length + _TAIL.size, position + _HEAD.size)
        if len(body) < length + _TAIL.size:
            return
        position += _HEAD.size + len(body)
        yield _entry(path, index, body), position
        index += 1


def _read(file: int, n_bytes: int, position: int) -> bytes:
    parts = []
    while n_bytes and (part := os.pread(file, n_bytes, position)):
        parts.append(part)
        position, n_bytes = position + len(part), n_bytes - len(part)
    return b"".join(parts)


def _entry(path: Path, index: int, body: bytes) -> Entry:
    payload, (crc,) = body[: -_TAIL.size], _TAIL.unpack(body[-_TAIL.size :])
    if crc32(payload) != crc:
        raise JournalError(f"{path}: entry {index} is damaged")
    try:
        return codec.decode(payload, _AnyEntry).e
    except MessageError as error:
        raise JournalError(f"{path}: entry {index} is not of this version ({error})") from error
