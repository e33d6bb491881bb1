"""Reading recordings: whole ones, parts of one, and what is left of one that was cut off."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Attachment as AttachmentRecord
from mcap.records import Channel, Chunk, Header, Message, Metadata

from legpush.errors import MessageError, RecordingError
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.telemetry import Copy, Origin
from legpush.recording.digests import DIGEST_TOPIC, Digests, Key, Mark
from legpush.recording.mcap_file.records import MAGIC, frames, is_attachment_whole, is_read, parsed
from legpush.recording.mcap_file.writer import COMPLETENESS, METADATA, Attachment, topic_of

RECOVERED_FROM: Final = "recovered_from"
"""In the metadata of what was made of a file that was cut off: its name."""


@dataclass(frozen=True, kw_only=True, slots=True)
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
    damaged_attachments: set[str] = field(default_factory=set)
    """Names of those whose bytes are not those that were recorded."""
    marks: dict[Key, Mark] = field(default_factory=dict)
    """What messages were when they were recorded."""
    files: list[Path] = field(default_factory=list)
    """In the order of their parts, whatever order they were given in."""
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

    @property
    def n_damaged(self) -> int:
        """Messages whose bytes are not those that were recorded."""
        return sum(not self.is_as_recorded(message) for message in self.messages)

    def attachment(self, name: str) -> Attachment | None:
        """Return the first file of this name, no matter of which process.

        Raises:
            RecordingError: It is damaged.
        """
        found = next((a for a in self.attachments.values() if a.name.rpartition("/")[2] == name), None)
        if found is not None and found.name in self.damaged_attachments:
            raise RecordingError(
                f"{found.name} of the recording is damaged: its bytes are not those that were recorded"
            )
        return found

    def mark(self, message: Recorded) -> Mark | None:
        """What a message was when it was recorded; None where no digest tells."""
        return self.marks.get((message.topic, message.origin.incarnation, message.copy.sequence))

    def is_as_recorded(self, message: Recorded) -> bool:
        """Whether its bytes are those that were recorded; True where no digest tells."""
        mark = self.mark(message)
        return mark is None or mark.crc == codec.checksum(message.copy.payload)


def read_recording(paths: Sequence[Path]) -> Recording:
    """Read all of a recording; parts may be given in any order.

    Raises:
        RecordingError: A file is empty, foreign, of another version, cut off or damaged.
    """
    if not paths:
        raise RecordingError("Expected the file of a recording, or the files of its parts, got none")
    recording = Recording()
    for scan in sorted((Scan(path) for path in paths), key=Scan.part):
        scan.read_into(recording)
        if not scan.ended:
            raise RecordingError(
                f"{scan.path}: expected a whole recording, got one that is cut off or damaged at byte {scan.position} "
                f"of {scan.size}; `legpush recover {scan.path}` makes a whole one of what is there"
            )
    return recording


class _Sender(NamedTuple):
    """What all messages of a channel have in common."""

    topic: str
    key: str
    origin: Origin


class Scan:
    """Reads one file as far as that is possible."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.ended = False
        """Whether the file has its end."""
        self.position = 0
        """Bytes that could be read."""
        self.size = 0
        self._is_ours = False
        self._channels: dict[int, Channel] = {}
        self._senders: dict[int, _Sender] = {}

    def part(self) -> int:
        """Return its number among the parts of its recording, as it says; 0 if it does not.

        Raises:
            RecordingError: It is no MCAP file.
        """
        with self._opened() as file:
            for opcode, data in self._frames(file):
                if opcode not in (Opcode.HEADER, Opcode.METADATA):
                    break
                record = parsed(opcode, data)
                if isinstance(record, Metadata) and record.name == METADATA:
                    said = record.metadata.get("part", "")
                    return int(said) if said.isdecimal() else 0
        return 0

    def read_into(self, recording: Recording) -> None:
        """Add what the file has.

        Raises:
            RecordingError: It is no recording of this protocol.
        """
        with self._opened() as file:
            for opcode, data in self._frames(file):
                self._take(opcode, data, recording)
        if not self._is_ours:
            what = "an MCAP file of something else" if self.ended else "one that is cut off before it says what it is"
            raise RecordingError(f"{self.path}: expected a recording of legpush, got {what}")
        recording.files.append(self.path)

    @contextmanager
    def _opened(self) -> Iterator[BinaryIO]:
        try:
            with self.path.open("rb") as file:
                self.size = self.path.stat().st_size
                head = file.read(len(MAGIC))
                if head != MAGIC:
                    got = "an empty file" if not head else f"one that begins with {head!r}"
                    raise RecordingError(f"{self.path}: expected a recording, an MCAP file, got {got}")
                yield file
        except OSError as error:
            raise RecordingError(f"{self.path}: expected a recording that can be read ({error.strerror})") from error

    def _frames(self, file: BinaryIO) -> Iterator[tuple[int, bytes]]:
        self.position = file.tell()
        for opcode, data in frames(file, self.size):
            yield opcode, data
            self.position = file.tell()
            if opcode == Opcode.FOOTER:
                self.ended = file.read() == MAGIC
                return

    def _take(self, opcode: int, data: bytes, recording: Recording) -> None:
        record = parsed(opcode, data)
        match record:
            case Header(profile=profile) if profile != METADATA:
                raise RecordingError(f"{self.path}: expected a recording of legpush, got an MCAP file of {profile!r}")
            case Metadata(name=name, metadata=metadata) if name == METADATA:
                self._take_about(dict(metadata), recording)
            case Metadata(name=name, metadata=metadata) if name == COMPLETENESS:
                recording.completeness = dict(metadata)
            case AttachmentRecord():
                self._take_attachment(record, data, recording)
            case Chunk():
                self._take_chunk(record, recording)
            case None if is_read(opcode):
                recording.n_damaged_chunks += 1
            case _:
                pass

    def _take_about(self, about: dict[str, str], recording: Recording) -> None:
        version = about.get("protocol")
        if version != str(PROTOCOL_VERSION):
            raise RecordingError(
                f"{self.path}: expected a recording of protocol version {PROTOCOL_VERSION}, got one of {version}"
            )
        said = about.pop("part", "0")
        if not said.isdecimal():
            raise RecordingError(f"{self.path}: expected the number of a part, got {said!r}")
        part, expected = int(said), recording.part + len(recording.files)
        about.pop(RECOVERED_FROM, None)
        self._is_ours = True
        if not recording.about:
            recording.about, recording.part = about, part
        elif recording.about != about:
            raise RecordingError(f"{self.path}: expected another part of the same recording, got one of another")
        elif part == expected - 1:
            raise RecordingError(f"{self.path}: expected each part once, got part {part} again, {recording.files[-1]}")
        elif part != expected:
            raise RecordingError(f"{self.path}: expected part {expected} of the recording, got part {part}")

    def _take_attachment(self, record: AttachmentRecord, data: bytes, recording: Recording) -> None:
        recording.attachments[record.name] = Attachment(record.name, record.media_type, record.data)
        if is_attachment_whole(data):
            recording.damaged_attachments.discard(record.name)
        else:
            recording.damaged_attachments.add(record.name)

    def _take_chunk(self, chunk: Chunk, recording: Recording) -> None:
        """Where its CRC is wrong it is read all the same, since digests tell which message is damaged."""
        if chunk.compression:
            raise RecordingError(f"{self.path}: expected chunks that are not compressed, got {chunk.compression}")
        recording.n_damaged_chunks += codec.checksum(chunk.data) != chunk.uncompressed_crc
        for opcode, data in frames(BytesIO(chunk.data), len(chunk.data)):
            record = parsed(opcode, data)
            if isinstance(record, Channel):
                self._channels[record.id] = record
            elif isinstance(record, Message):
                self._take_message(record, recording)

    def _take_message(self, message: Message, recording: Recording) -> None:
        channel = self._channels.get(message.channel_id)
        if channel is None:
            return  # Its channel is damaged, or its number: one of those that cannot be read.
        if channel.topic == DIGEST_TOPIC:
            _take_digests(message.data, recording)
            return
        sender = self._senders.get(channel.id)
        if sender is None:
            sender = self._senders[channel.id] = self._sender(channel)
        copy = Copy(key=sender.key, sequence=message.sequence, time_ns=message.publish_time, payload=message.data)
        recording.messages.append(Recorded(topic=sender.topic, origin=sender.origin, copy=copy))

    def _sender(self, channel: Channel) -> _Sender:
        about = channel.metadata
        try:
            origin = codec.convert({name: about.get(name) for name in ("role", "name", "incarnation")}, Origin)
        except MessageError as error:
            raise RecordingError(f"{self.path}: channel {channel.topic} has no sender ({error})") from error
        key = about.get("key", channel.topic)
        return _Sender(topic_of(key), key, origin)


def _take_digests(data: bytes, recording: Recording) -> None:
    try:
        digests = codec.decode(data, Digests)
    except MessageError:
        return
    for each in digests.digests:
        for sequence, crc, place in zip(each.sequences, each.crcs, each.places, strict=False):
            recording.marks[each.topic, each.incarnation, sequence] = Mark(crc, place)
