"""Reads recordings: whole ones, parts of one, and the rest of one that was cut off."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Attachment as AttachmentRecord
from mcap.records import Channel, Chunk, Header, Message, Metadata

from legpush.errors import MessageError, RecordingError
from legpush.messages import codec
from legpush.messages.common import READABLE_VERSIONS
from legpush.messages.telemetry import Copy, Origin
from legpush.recording.digests import DIGEST_TOPIC, Digests, Mark
from legpush.recording.mcap_file.contents import Recorded, Recording
from legpush.recording.mcap_file.integrity import Integrity, damaged_indexes
from legpush.recording.mcap_file.records import MAGIC, frames, is_attachment_whole, is_read, parsed
from legpush.recording.mcap_file.salvage import Gap, read_summary, salvaged
from legpush.recording.mcap_file.writer import COMPLETENESS, METADATA, Attachment, topic_of

RECOVERED_FROM: Final = "recovered_from"
"""Key in the metadata of a recovered recording, for the name of the file that was cut off."""


def read_recording(paths: Sequence[Path]) -> Recording:
    """Return everything in a recording; its parts may be given in any order.

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
                f"of {scan.size}; `legpush recover {scan.path}` makes a whole one from the rest"
            )
    return recording


class _Sender(NamedTuple):
    """Topic, key and origin of all messages of a channel."""

    topic: str
    key: str
    origin: Origin


class Scan:
    """Reads one file as far as possible."""

    def __init__(self, path: Path, *, salvages: bool = False) -> None:
        """With `salvages`, go on behind a record whose end cannot be found."""
        self.path = path
        self.ended = False
        """Whether the file could be read to its end."""
        self.position = 0
        """Number of bytes that could be read."""
        self.size = 0
        self.gaps: list[Gap] = []
        """Parts of the file that cannot be read, with readable ones behind them."""
        self._salvages = salvages
        self._is_ours = False
        self._is_damage_known = False
        self._channels: dict[int, Channel] = {}
        self._senders: dict[int, _Sender] = {}

    def part(self) -> int:
        """Return the number of the file among the parts of its recording; 0 if the file does not have it.

        Raises:
            RecordingError: The file cannot be opened, or is not an MCAP file.
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
        """Add the contents of the file to a recording.

        Raises:
            RecordingError: The file is not a recording of this protocol, or not the next part of `recording`.
        """
        integrity = Integrity()
        with self._opened() as file:
            if self._salvages:
                self._channels.update(read_summary(file).channels)
            for opcode, data in self._frames(file):
                integrity.take(opcode, data)
                self._take(opcode, data, recording)
        if not self._is_ours:
            what = "an MCAP file of another kind" if self.ended else "one that is cut off before its metadata"
            raise RecordingError(f"{self.path}: expected a recording of legpush, got {what}")
        recording.files.append(self.path)
        if self.ended and not self.gaps:
            self._take_integrity(integrity, recording)

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
        records = salvaged(file, self.size, self.gaps) if self._salvages else frames(file, self.size)
        for opcode, data in records:
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
                self._note(f"the record at byte {self.position}", recording)
            case _:
                pass

    def _take_integrity(self, integrity: Integrity, recording: Recording) -> None:
        """Note what is damaged besides chunks and attachments."""
        if integrity.is_data_damaged:
            for words in damaged_indexes(self.path):
                self._note(words, recording)
            if not self._is_damage_known:
                self._note("the header, the metadata, or the CRC of the data", recording)
        if integrity.is_summary_damaged:
            self._note("the summary", recording)

    def _note(self, words: str, recording: Recording) -> None:
        self._is_damage_known = True
        recording.damaged_records.append(f"{words} of {self.path.name}")

    def _take_about(self, about: dict[str, str], recording: Recording) -> None:
        version = about.get("protocol")
        if version not in [str(each) for each in READABLE_VERSIONS]:
            *others, newest = map(str, READABLE_VERSIONS)
            versions = f"{', '.join(others)} or {newest}"
            raise RecordingError(
                f"{self.path}: other version: expected a recording of protocol version {versions}, got one of {version}"
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
            raise RecordingError(f"{self.path}: expected another part of the same recording, got a part of another one")
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
            self._is_damage_known = True

    def _take_chunk(self, chunk: Chunk, recording: Recording) -> None:
        """Read a chunk even if its CRC is wrong, since digests show which message is damaged."""
        if chunk.compression:
            raise RecordingError(f"{self.path}: expected chunks that are not compressed, got {chunk.compression}")
        if codec.checksum(chunk.data) != chunk.uncompressed_crc:
            self._note(f"the chunk at byte {self.position}", recording)
        for opcode, data in frames(BytesIO(chunk.data), len(chunk.data)):
            record = parsed(opcode, data)
            if isinstance(record, Channel):
                self._channels[record.id] = record
            elif isinstance(record, Message):
                self._take_message(record, recording)

    def _take_message(self, message: Message, recording: Recording) -> None:
        channel = self._channels.get(message.channel_id)
        if channel is None:
            return  # The channel or its number is damaged, so the message cannot be read.
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
