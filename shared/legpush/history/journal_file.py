"""The file of a journal: a magic number, then frames. Says where a damaged file is whole, and cuts it there.

A frame is a length and its CRC-32, the payload, and the payload's CRC-32, all big-endian.
"""

import fcntl
import os
import shutil
import struct
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Final
from zlib import crc32

from legpush.errors import JournalError
from legpush.files import new_file

MAGIC: Final = b"legpush journal\n"
DAMAGED: Final = ".damaged"
"""Suffix for the name of the original of a file that was cut."""
_HEAD: Final = struct.Struct(">II")
_TAIL: Final = struct.Struct(">I")


def lock(path: Path, file: int) -> None:
    """Keep other processes from writing to the journal until it is closed.

    Raises:
        JournalError: Another process writes to it.
    """
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise JournalError(f"{path} is in use by another process") from error


def frame(payload: bytes) -> bytes:
    """Return the frame of a payload."""
    length = struct.pack(">I", len(payload))
    return length + _TAIL.pack(crc32(length)) + payload + _TAIL.pack(crc32(payload))


def payloads(file: int, position: int) -> Iterator[tuple[bytes, int]]:
    """Yield each payload with the position at which its frame ends, up to the first frame that is not whole."""
    while (length := _length(os.pread(file, _HEAD.size, position))) is not None:
        body = _read(file, length + _TAIL.size, position + _HEAD.size)
        payload = body[:length]
        if body[length:] != _TAIL.pack(crc32(payload)):
            return
        position += _HEAD.size + len(body)
        yield payload, position


def is_incomplete(file: int, position: int) -> bool:
    """Return whether the file ends within the frame at this position, as after a kill in the middle of a write."""
    head = os.pread(file, _HEAD.size, position)
    if len(head) < _HEAD.size:
        return True
    length = _length(head)
    return length is not None and position + _HEAD.size + length + _TAIL.size > os.fstat(file).st_size


def is_whole_after(file: int, position: int) -> bool:
    """Return whether a whole frame begins anywhere behind the damaged one at this position."""
    length = _length(os.pread(file, _HEAD.size, position))
    if length is not None:
        behind = position + _HEAD.size + length + _TAIL.size
        if next(payloads(file, behind), None) is not None:
            return True
    rest = _read(file, os.fstat(file).st_size - position, position)
    least = _HEAD.size + _TAIL.size
    for at in range(1, len(rest) - least):
        n_bytes = int.from_bytes(rest[at : at + 4])
        if not 0 < n_bytes <= len(rest) - at - least or _length(rest[at : at + _HEAD.size]) is None:
            continue
        if next(payloads(file, position + at), None) is not None:
            return True
    return False


def cut(path: Path, file: int, position: int) -> Path:
    """Cut the file off at this position, after a copy of it was put beside it; return the path of the copy.

    Raises:
        OSError: The copy cannot be made; the file is as it was.
    """
    names = (path.with_name(f"{path.name}{DAMAGED}{f'-{number}' if number else ''}") for number in count())
    kept = next(name for name in names if not name.exists())
    with new_file(kept, private=True) as scratch:
        shutil.copyfile(path, scratch)
    os.ftruncate(file, position)
    os.fsync(file)
    return kept


def _length(head: bytes) -> int | None:
    """Return the length in the head of a frame; None if the head is not whole."""
    if len(head) < _HEAD.size:
        return None
    length, crc = _HEAD.unpack(head)
    return int(length) if crc32(head[:4]) == crc else None


def _read(file: int, n_bytes: int, position: int) -> bytes:
    parts = []
    while n_bytes and (part := os.pread(file, n_bytes, position)):
        parts.append(part)
        position, n_bytes = position + len(part), n_bytes - len(part)
    return b"".join(parts)
