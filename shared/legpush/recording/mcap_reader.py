"""Reading recordings: whole ones, parts of one, and what is left of one that was cut off."""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, Final

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment as AttachmentRecord
from mcap.records import Channel, Chunk, Footer, Header, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader

from legpush import codec
from legpush.errors import MessageError, RecordingError
from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.tap import Copy, Origin
from legpush.recording.digests import DIGEST_TOPIC, Digests
from legpush.recording.mcap_writer import COMPLETENESS, METADATA, Attachment, topic_of

RECOVERED_FROM: Final = "recovered_from"
"""In the metadata of what was made of a file that was cut off: its name."""
MAGIC: Final = b"\x89MCAP0\r\n"
_DAMAGE: Final = (McapError, struct.error, ValueError, KeyError, MemoryError)
"""What the MCAP library raises where a file is not what it should be."""


@dataclass(frozen=True, kw_only=True)
class Recorded:
    """A message of a recording."""

    topic: str
    origin: Origin
    copy: Copy

    @property
    def place(self) -> str:
        """For messages to people."""
        return f"{self.topic} of {self.origin.role} {self.origin.name}, sequence {self.copy.sequence}"


@dataclass(kw_only=True)
class Recording:
    """Everything in a recording."""

    about: dict[str, str] = field(default_factory=dict)
    """The metadata that it began with."""
    completeness: dict[str, str] = field(default_factory=dict)
    """What its recorder said at its end; empty where it did not come to that."""
    messages: list[Recorded] = field(default_factory=list)
    """In the order in which they came to the recorder: in that of the sender, for each sender."""
    attachments: dict[str, Attachment] = field(default_factory=dict)
    crcs: dict[tuple[str, str, int], int] = field(default_factory=dict)
    """Digests by topic, incarnation and sequence."""
    n_files: int = 0
    part: int = 0
    """Number of the first file among the parts of its recording."""
    n_damaged_chunks: int = 0
    """Pieces of the files with a bit that flipped, in a message or beside it."""

    @property
    def is_complete(self) -> bool:
        """Whether it says so, and has as many messages as it says."""
        return self.completeness.get("complete") == "yes" and self.n_lost == 0

    @property
    def n_lost(self) -> int:
        """Messages that were recorded, but cannot be read: the file is damaged, or parts of it are not there."""
        said = self.completeness.get("n_recorded", "")
        return max(0, int(said) - len(self.messages)) if said.isdecimal() else 0

    def attachment(self, name: str) -> Attachment | None:
        """The first file of this name, of whichever process."""
        return next((a for a in self.attachments.values() if a.name.rpartition("/")[2] == name), None)

    def is_as_recorded(self, message: Recorded) -> bool:
        """Whether its bytes are those that were recorded; True where no digest tells."""
        crc = self.crcs.get((message.topic, message.origin.incarnation, message.copy.sequence))
        return crc is None or crc == codec.checksum(message.copy.payload)


def read_recording(paths: Sequence[Path]) -> Recording:
    """All of a recording; `RecordingError` where a file is empty, foreign, of another version, cut off or damaged."""
    if not paths:
        raise RecordingError("Expected the file of a recording, or the files of its parts, got none")
    recording = Recording()
    for path in paths:
        scan = Scan(path)
        scan.read_into(recording)
        if not scan.ended:
            raise RecordingError(
                f"{path}: expected a whole recording, got one that is cut off or damaged at byte {scan.position} of "
                f"{scan.size}; `legpush recover {path}` makes a whole one of what is there"
            )
    return recording


class Scan:
    """Reads one file as far as that is possible."""

    def __init__(self, path: Path) -> None:
        """`RecordingError` where there is no recording."""
        self.path = path
        self.ended = False
        """Whether the file has its end."""
        self.position = 0
        """Bytes that could be read."""
        self.size = 0
        self.n_damaged_chunks = 0
        self._is_ours = False
        self._channels: dict[int, Channel] = {}

    def read_into(self, recording: Recording) -> None:
        """Add what the file has; `RecordingError` where it is no recording of this protocol."""
        try:
            with self.path.open("rb") as file:
                self.size = self.path.stat().st_size
                self._require_magic(file)
                for record in self._records(file):
                    self._take(record, recording)
        except OSError as error:
            raise RecordingError(f"{self.path}: expected a recording that can be read ({error.strerror})") from error
        if not self._is_ours:
            what = "an MCAP file of something else" if self.ended else "one that is cut off before it says what it is"
            raise RecordingError(f"{self.path}: expected a recording of legpush, got {what}")
        recording.n_files += 1
        recording.n_damaged_chunks += self.n_damaged_chunks

    def _require_magic(self, file: BinaryIO) -> None:
        head = file.read(len(MAGIC))
        if head != MAGIC:
            got = "an empty file" if not head else f"one that begins with {head!r}"
            raise RecordingError(f"{self.path}: expected a recording, an MCAP file, got {got}")
        file.seek(0)

    def _records(self, file: BinaryIO) -> Iterator[McapRecord]:
        """Each record, those of chunks one by one, up to the first that is not whole."""
        try:
            for record in StreamReader(file, emit_chunks=True).records:
                if isinstance(record, Chunk):
                    yield from self._chunk_records(record)
                else:
                    yield record
                self.position = file.tell()
                self.ended |= isinstance(record, Footer)
        except _DAMAGE:
            self.ended = False

    def _chunk_records(self, chunk: Chunk) -> Iterator[McapRecord]:
        """Of a chunk; where its CRC is wrong it is read all the same, since digests tell which message is damaged."""
        if chunk.compression:
            raise RecordingError(f"{self.path}: expected chunks that are not compressed, got {chunk.compression}")
        self.n_damaged_chunks += codec.checksum(chunk.data) != chunk.uncompressed_crc
        stream, n_bytes = ReadDataStream(BytesIO(chunk.data)), len(chunk.data)
        while stream.count < n_bytes:
            opcode, length = stream.read1(), stream.read8()
            if stream.count + length > n_bytes:
                return
            if opcode == Opcode.MESSAGE:
                yield Message.read(stream, length)
            elif opcode == Opcode.CHANNEL:
                yield Channel.read(stream)
            elif opcode == Opcode.SCHEMA:
                yield Schema.read(stream)
            else:
                stream.read(length)

    def _take(self, record: McapRecord, recording: Recording) -> None:
        match record:
            case Header(profile=profile) if profile != METADATA:
                raise RecordingError(f"{self.path}: expected a recording of legpush, got an MCAP file of {profile!r}")
            case Metadata(name=name, metadata=metadata) if name == METADATA:
                self._take_about(dict(metadata), recording)
            case Metadata(name=name, metadata=metadata) if name == COMPLETENESS:
                recording.completeness = dict(metadata)
            case Channel():
                self._channels[record.id] = record
            case AttachmentRecord():
                attachment = Attachment(record.name, record.media_type, record.data)
                recording.attachments[record.name] = attachment
            case Message():
                self._take_message(record, recording)
            case _:
                pass

    def _take_about(self, about: dict[str, str], recording: Recording) -> None:
        version = about.get("protocol")
        if version != str(PROTOCOL_VERSION):
            raise RecordingError(
                f"{self.path}: expected a recording of protocol version {PROTOCOL_VERSION}, got one of {version}"
            )
        said, expected = about.pop("part", "0"), recording.part + recording.n_files
        if not said.isdecimal():
            raise RecordingError(f"{self.path}: expected the number of a part, got {said!r}")
        part = int(said)
        about.pop(RECOVERED_FROM, None)
        self._is_ours = True
        if not recording.about:
            recording.part = part
        elif part != expected:
            raise RecordingError(f"{self.path}: expected part {expected} of the recording, got part {part}")
        if not recording.about:
            recording.about = about
        elif recording.about != about:
            raise RecordingError(f"{self.path}: expected another part of the same recording, got one of another")

    def _take_message(self, message: Message, recording: Recording) -> None:
        channel = self._channels.get(message.channel_id)
        if channel is None:
            raise RecordingError(f"{self.path}: a message belongs to channel {message.channel_id}, which is none")
        if channel.topic == DIGEST_TOPIC:
            try:
                digests = codec.decode(message.data, Digests)
            except MessageError:
                return
            for each in digests.digests:
                for sequence, crc in zip(each.sequences, each.crcs, strict=False):
                    recording.crcs[each.topic, each.incarnation, sequence] = crc
            return
        about = channel.metadata
        try:
            origin = codec.convert({name: about.get(name) for name in ("role", "name", "incarnation")}, Origin)
        except MessageError as error:
            raise RecordingError(f"{self.path}: channel {channel.topic} has no sender ({error})") from error
        copy = Copy(
            key=about.get("key", channel.topic),
            sequence=message.sequence,
            time_ns=message.publish_time,
            payload=message.data,
        )
        recording.messages.append(Recorded(topic=topic_of(copy.key), origin=origin, copy=copy))
