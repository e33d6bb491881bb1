"""Checks an MCAP file with the CRCs of its data and of its summary, and finds the record that is damaged."""

import struct
from collections import defaultdict
from io import BytesIO
from pathlib import Path
from typing import Final
from zlib import crc32

from mcap.opcode import Opcode
from mcap.records import Chunk, Message, MessageIndex

from legpush.recording.mcap_file.records import FRAME, MAGIC, frames, parsed, parsed_index

_CRC: Final = struct.Struct("<I")
_FOOTER: Final = struct.Struct("<QQI")
"""Start of the summary, start of its offsets, CRC."""


class Integrity:
    """Checks the records of a file as they are read."""

    def __init__(self) -> None:
        self.is_data_damaged = False
        """Whether the CRC of everything before the summary is wrong."""
        self.is_summary_damaged = False
        self._crc = crc32(MAGIC)
        self._position = len(MAGIC)
        self._summary_start: int | None = None

    def take(self, opcode: int, data: bytes) -> None:
        """Check the next record. A CRC of 0 means that the file has none."""
        head = FRAME.pack(opcode, len(data))
        self._position += len(head) + len(data)
        if opcode == Opcode.DATA_END and self._summary_start is None:
            (stated,) = _CRC.unpack(data) if len(data) == _CRC.size else (None,)
            self.is_data_damaged = stated not in (0, self._crc)
            self._crc, self._summary_start = 0, self._position
        elif opcode == Opcode.FOOTER:
            self._check_summary(head, data)
        else:
            self._crc = crc32(data, crc32(head, self._crc))

    def _check_summary(self, head: bytes, data: bytes) -> None:
        if self._summary_start is None:
            self.is_data_damaged = True
        if len(data) != _FOOTER.size:
            self.is_summary_damaged = True
            return
        stated = _FOOTER.unpack(data)[-1]
        crc = crc32(data[: -_CRC.size], crc32(head, self._crc))
        self.is_summary_damaged = self._summary_start is not None and stated not in (0, crc)


def damaged_indexes(path: Path) -> list[str]:
    """Return the message indexes that do not fit their undamaged chunk, in words for people."""
    found: list[str] = []
    expected: dict[int, list[tuple[int, int]]] | None = None
    chunk_at, position = 0, len(MAGIC)
    with path.open("rb") as file:
        file.seek(position)
        for opcode, data in frames(file, path.stat().st_size):
            words = f"the index of the chunk at byte {chunk_at}"
            if opcode != Opcode.MESSAGE_INDEX:
                found += [words] if expected else []
                chunk = parsed(opcode, data)
                chunk_at, expected = position, _index_of(chunk) if isinstance(chunk, Chunk) else None
            elif expected is not None:
                index = parsed_index(opcode, data)
                if not isinstance(index, MessageIndex) or expected.pop(index.channel_id, None) != index.records:
                    found.append(words)
                    expected = None
            position = file.tell()
    return found


def _index_of(chunk: Chunk) -> dict[int, list[tuple[int, int]]] | None:
    """Return time and position of each message of a chunk, by channel; None if the chunk is damaged."""
    if crc32(chunk.data) != chunk.uncompressed_crc:
        return None
    index: dict[int, list[tuple[int, int]]] = defaultdict(list)
    content, at = BytesIO(chunk.data), 0
    for opcode, data in frames(content, len(chunk.data)):
        record = parsed(opcode, data)
        if isinstance(record, Message):
            index[record.channel_id].append((record.log_time, at))
        at = content.tell()
    return dict(index)
