"""Reads each record of an MCAP file by itself, so that a damaged one does not keep others from being read.

https://mcap.dev/spec
"""

import struct
from collections.abc import Iterator
from io import BytesIO
from typing import BinaryIO, Final

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    MetadataIndex,
)

from legpush.messages import codec

MAGIC: Final = b"\x89MCAP0\r\n"
FRAME: Final = struct.Struct("<BQ")
"""The head of every record: opcode, number of bytes that follow."""
_CRC: Final = struct.Struct("<I")
_KINDS: Final[dict[int, type[McapRecord]]] = {
    Opcode.HEADER: Header,
    Opcode.METADATA: Metadata,
    Opcode.ATTACHMENT: Attachment,
    Opcode.CHANNEL: Channel,
    Opcode.CHUNK: Chunk,
}
"""Records that are read besides messages."""
_INDEXES: Final[dict[int, type[McapRecord]]] = {
    Opcode.MESSAGE_INDEX: MessageIndex,
    Opcode.CHUNK_INDEX: ChunkIndex,
    Opcode.ATTACHMENT_INDEX: AttachmentIndex,
    Opcode.METADATA_INDEX: MetadataIndex,
    Opcode.DATA_END: DataEnd,
    Opcode.FOOTER: Footer,
}
"""Records that say where others are."""
_DAMAGE: Final = (McapError, struct.error, ValueError, KeyError, MemoryError)
"""Errors that the MCAP library raises for a damaged record."""


def frames(file: BinaryIO, n_bytes: int) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and bytes of each record of a file or chunk of this size, up to the first that is cut off."""
    while len(head := file.read(FRAME.size)) == FRAME.size:
        opcode, length = FRAME.unpack(head)
        if length > n_bytes - file.tell():
            return
        yield opcode, file.read(length)


def parsed(opcode: int, data: bytes) -> McapRecord | None:
    """Return a record of the kinds that are read here; None for other kinds, and for a damaged record."""
    if opcode == Opcode.MESSAGE:
        try:
            message: Message = Message.read(ReadDataStream(BytesIO(data)), len(data))
        except _DAMAGE:
            return None
        return message
    return _read(_KINDS.get(opcode), data)[0]


def parsed_index(opcode: int, data: bytes) -> McapRecord | None:
    """Return a record that says where others are; None for other kinds, and for a damaged record."""
    return _read(_INDEXES.get(opcode), data)[0]


def is_exact(opcode: int, data: bytes) -> bool:
    """Return whether the bytes are one record of a known kind, and nothing else."""
    record, n_bytes = _read({**_KINDS, **_INDEXES}.get(opcode), data)
    return record is not None and n_bytes == len(data)


def _read(kind: type[McapRecord] | None, data: bytes) -> tuple[McapRecord | None, int]:
    """Return a record of this kind, or None, and the number of bytes that were read."""
    stream = ReadDataStream(BytesIO(data))
    try:
        record: McapRecord | None = kind.read(stream) if kind is not None else None  # type: ignore[attr-defined]
    except _DAMAGE:
        return None, 0
    return record, stream.count


def is_read(opcode: int) -> bool:
    """Return whether records of this kind are read here; then None from `parsed` means damage."""
    return opcode in _KINDS


def is_attachment_whole(data: bytes) -> bool:
    """Return whether the CRC at the end of an attachment matches its contents."""
    return bool(_CRC.unpack(data[-_CRC.size :])[0] == codec.checksum(data[: -_CRC.size]))
