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
from mcap.records import Attachment, Channel, Chunk, Header, McapRecord, Message, Metadata

from legpush.messages import codec

MAGIC: Final = b"\x89MCAP0\r\n"
_FRAME: Final = struct.Struct("<BQ")
"""The head of every record: opcode, number of bytes that follow."""
_CRC: Final = struct.Struct("<I")
_KINDS: Final[dict[int, type[Header | Metadata | Attachment | Channel | Chunk]]] = {
    Opcode.HEADER: Header,
    Opcode.METADATA: Metadata,
    Opcode.ATTACHMENT: Attachment,
    Opcode.CHANNEL: Channel,
    Opcode.CHUNK: Chunk,
}
"""Records that are read besides messages."""
_DAMAGE: Final = (McapError, struct.error, ValueError, KeyError, MemoryError)
"""Errors that the MCAP library raises for a damaged record."""


def frames(file: BinaryIO, n_bytes: int) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and bytes of each record of a file or chunk of this size, up to the first that is cut off."""
    while len(head := file.read(_FRAME.size)) == _FRAME.size:
        opcode, length = _FRAME.unpack(head)
        if length > n_bytes - file.tell():
            return
        yield opcode, file.read(length)


def parsed(opcode: int, data: bytes) -> McapRecord | None:
    """Return a record of the kinds that are read here; None for other kinds, and for a damaged record."""
    stream = ReadDataStream(BytesIO(data))
    kind = _KINDS.get(opcode)
    try:
        if opcode == Opcode.MESSAGE:
            message: Message = Message.read(stream, len(data))
            return message
        record: McapRecord | None = kind.read(stream) if kind is not None else None
    except _DAMAGE:
        return None
    return record


def is_read(opcode: int) -> bool:
    """Return whether records of this kind are read here; then None from `parsed` means damage."""
    return opcode in _KINDS


def is_attachment_whole(data: bytes) -> bool:
    """Return whether the CRC at the end of an attachment matches its contents."""
    return bool(_CRC.unpack(data[-_CRC.size :])[0] == codec.checksum(data[: -_CRC.size]))
