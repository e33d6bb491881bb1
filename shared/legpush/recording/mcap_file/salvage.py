"""Goes through the records of a damaged MCAP file, and goes on behind a record whose end cannot be found.

The next record is the next one in the index of the summary, if that can be read; else the next bytes that are a whole
record by their opcode, their lengths and their CRC.
"""

import re
import struct
from collections.abc import Iterator
from mmap import ACCESS_READ, mmap
from typing import BinaryIO, Final, NamedTuple
from zlib import crc32

from mcap.opcode import Opcode
from mcap.records import AttachmentIndex, Channel, ChunkIndex, MetadataIndex

from legpush.recording.mcap_file.records import FRAME, MAGIC, is_attachment_whole, is_exact, parsed, parsed_index

_FOOTER: Final = struct.Struct("<BQQQI")
"""Opcode, length, start of the summary, start of its offsets, CRC."""
_DATA_END_BYTES: Final = FRAME.size + 4
_CANDIDATE: Final = re.compile(rb"[\x06\x09\x0c\x0f](?=.{4}\x00{4})", re.DOTALL)
"""Opcode and length of a chunk, an attachment, a metadata record, or the end of the data, of less than 4 GiB."""
_CHUNK: Final = struct.Struct("<QQQIIQ")
"""Two times, size and CRC of the records, length of the compression's name (0), length of the records."""


class Gap(NamedTuple):
    """A part of a file that cannot be read."""

    begin: int
    end: int


class Summary(NamedTuple):
    """What the summary says about the file; all empty if it cannot be read."""

    channels: dict[int, Channel]
    starts: list[int]
    """Positions of records, in order."""


def salvaged(file: BinaryIO, n_bytes: int, gaps: list[Gap]) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and bytes of each record that can be found; the parts between them are added to `gaps`.

    The file stands behind the record that was yielded last.
    """
    starts = read_summary(file).starts
    with mmap(file.fileno(), 0, access=ACCESS_READ) as data:
        at = len(MAGIC)
        while at + FRAME.size <= n_bytes:
            end = _end(data, at)
            if end is None:
                behind = _next(data, at, starts)
                if behind is None:
                    return
                begin = gaps.pop().begin if gaps and gaps[-1].end == at else at
                gaps.append(Gap(begin, behind))
                at = behind
                continue
            file.seek(end)
            yield data[at], data[at + FRAME.size : end]
            at = end


def read_summary(file: BinaryIO) -> Summary:
    """Read the summary, if its CRC is right."""
    with mmap(file.fileno(), 0, access=ACCESS_READ) as data:
        return _summary(data)


def _summary(data: mmap) -> Summary:
    found = Summary({}, [])
    footer = len(data) - len(MAGIC) - _FOOTER.size
    if footer < 0 or data[-len(MAGIC) :] != MAGIC:
        return found
    opcode, _, start, _, crc = _FOOTER.unpack_from(data, footer)
    if opcode != Opcode.FOOTER or not 0 < start <= footer or crc32(data[start : len(data) - 12]) != crc:
        return found
    starts = {start - _DATA_END_BYTES, start}
    at = start
    while at < footer:
        opcode, length = FRAME.unpack_from(data, at)
        content = data[at + FRAME.size : at + FRAME.size + length]
        match parsed(opcode, content) or parsed_index(opcode, content):
            case Channel() as channel:
                found.channels[channel.id] = channel
            case ChunkIndex(chunk_start_offset=position, message_index_offsets=indexes):
                starts |= {position, *indexes.values()}
            case AttachmentIndex(offset=position):
                starts.add(position)
            case MetadataIndex(offset=position):
                starts.add(position)
            case _:
                pass
        at += FRAME.size + length
    found.starts.extend(sorted(starts))
    return found


def _end(data: mmap, at: int) -> int | None:
    """Return where the record at this position ends; None if that cannot be found."""
    opcode, length = FRAME.unpack_from(data, at)
    if opcode == Opcode.CHUNK and (true := _length_of_chunk(data, at)) is not None:
        return at + FRAME.size + true
    end = at + FRAME.size + int(length)
    if end > len(data):
        return None
    return end if _is_plausible(data, end) or _is_whole(data, at) else None


def _length_of_chunk(data: mmap, at: int) -> int | None:
    """Return the length of a chunk without compression from its own fields, if its CRC is right."""
    begin = at + FRAME.size
    if begin + _CHUNK.size > len(data):
        return None
    _, _, size, crc, n_compression, n_records = _CHUNK.unpack_from(data, begin)
    records = begin + _CHUNK.size
    if n_compression or size != n_records or n_records > len(data) - records:
        return None
    return _CHUNK.size + int(n_records) if crc32(data[records : records + n_records]) == crc else None


def _is_plausible(data: mmap, at: int) -> bool:
    """Return whether a record can begin here, or the file ends here."""
    if len(data) - at in (0, len(MAGIC)):
        return True
    if at + FRAME.size > len(data):
        return False
    opcode, length = FRAME.unpack_from(data, at)
    return bool(Opcode.HEADER <= opcode <= Opcode.DATA_END and at + FRAME.size + length <= len(data))


def _is_whole(data: mmap, at: int) -> bool:
    """Return whether the bytes here are a whole record by its lengths, and by its CRC if it has one."""
    opcode, length = FRAME.unpack_from(data, at)
    end = at + FRAME.size + length
    if end > len(data):
        return False
    if opcode == Opcode.CHUNK:
        return bool(_length_of_chunk(data, at) == length)
    content = data[at + FRAME.size : end]
    return is_exact(opcode, content) and (opcode != Opcode.ATTACHMENT or is_attachment_whole(content))


def _next(data: mmap, at: int, starts: list[int]) -> int | None:
    """Return where the next record behind this position begins; None if there is no other."""
    known = next((start for start in starts if start > at), None)
    if known is not None:
        return known
    found = (match.start() for match in _CANDIDATE.finditer(data, at + 1))
    return next((start for start in found if _is_whole(data, start)), None)
