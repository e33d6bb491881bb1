"""Writes recordings as MCAP files: in small chunks that are flushed often, and in parts by size or time.

So a kill loses little. Chunks are not compressed, so that a flipped bit damages one message, which its digest shows.
"""

import json
import os
import re
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from time import monotonic, time_ns
from typing import Final, NamedTuple, cast

from mcap.writer import CompressionType, Writer
from msgspec import Struct

from legpush.errors import RecordingError
from legpush.files import PRIVATE_FILE
from legpush.messages import codec, planning, stepping, telemetry
from legpush.messages.schemas import json_schema
from legpush.messages.telemetry import Copy, Origin
from legpush.recording.digests import DIGEST_TOPIC, Digest, Digests, Key, Mark, mark_of

CHUNK_BYTES: Final = 64 * 1024
METADATA: Final = "legpush"
"""Name of the metadata record that only recordings have, unlike other MCAP files."""
COMPLETENESS: Final = "completeness"
"""Name of the metadata record that states how complete the recording is."""
ENCODING: Final = "msgpack"


class Split(NamedTuple):
    """The size and the duration after which a recording continues in another file."""

    n_bytes: int | None = None
    seconds: float | None = None


WHOLE: Final = Split()
"""Keep a recording in one file."""


class Attachment(NamedTuple):
    """A file inside a recording."""

    name: str
    media_type: str
    data: bytes


def topic_of(key: str) -> str:
    """Return the name of a key in a recording: without the prefix that all keys of a run have."""
    return key.split("/", 3)[3] if key.count("/") >= 3 else key


class RecordingFile:
    """A recording that is being written.

    With a `split` it consists of parts `<name>-000.mcap`, `<name>-001.mcap` and so on, each a whole MCAP file. Its
    methods raise `RecordingError` for errors of the file system; everything that was flushed before is kept.
    """

    def __init__(self, path: Path, about: Mapping[str, str], split: Split = WHOLE, part: int = 0) -> None:
        """Begin a recording; `about` becomes the metadata of every part, the first of which has the number `part`.

        Raises:
            RecordingError: A file of this name, or of the name of a part, exists.
        """
        self._first_part = part
        self._path = path
        self._about = dict(about)
        self._split = split
        self._attachments: dict[str, Attachment] = {}
        self.parts: list[Path] = []
        """The files of the parts, in order."""
        if split != WHOLE:
            self._require_no_parts()
        self._open()

    @property
    def n_bytes(self) -> int:
        """Size of the present part, without messages that have not been flushed."""
        return self._stream.position

    def write(self, origin: Origin, copies: tuple[Copy, ...], marks: Mapping[Key, Mark] | None = None) -> None:
        """Add messages of one sender, with their digests; messages that were recorded before keep those in `marks`."""
        digests: dict[str, list[tuple[int, Mark]]] = {}
        for copy in copies:
            topic = topic_of(copy.key)
            channel = self._channel(topic, copy.key, origin)
            self._writer.add_message(channel, copy.time_ns, copy.payload, copy.time_ns, copy.sequence % 2**32)
            mark = (marks or {}).get((topic, origin.incarnation, copy.sequence)) or mark_of(copy.payload)
            digests.setdefault(topic, []).append((copy.sequence, mark))
        if copies:
            record = Digests(
                digests=tuple(
                    Digest(
                        topic=topic,
                        incarnation=origin.incarnation,
                        sequences=tuple(sequence for sequence, _ in pairs),
                        crcs=tuple(mark.crc for _, mark in pairs),
                        places=tuple(mark.place for _, mark in pairs),
                    )
                    for topic, pairs in digests.items()
                )
            )
            at = copies[-1].time_ns
            self._writer.add_message(self._digest_channel(), at, codec.encode(record), at)

    def attach(self, attachment: Attachment) -> None:
        """Add a file to this part and the parts that follow."""
        before = self._attachments.get(attachment.name)
        if before != attachment:
            self._attachments[attachment.name] = attachment
            self._add(attachment)

    def flush(self) -> None:
        """Make sure that everything written before survives a kill; begin another part if this one is long enough."""
        self._writer.flush()  # type: ignore[no-untyped-call]
        self._stream.mark_whole()
        limit_bytes, limit_s = self._split
        too_large = limit_bytes is not None and self._stream.position >= limit_bytes
        if too_large or (limit_s is not None and monotonic() - self._began >= limit_s):
            self._writer.add_metadata(COMPLETENESS, {"complete": "unknown", "notes": "the last part states it for all"})
            self._end()
            self._open()

    def finish(self, completeness: Mapping[str, str]) -> None:
        """Write the completeness and the index, and close the file."""
        self._writer.add_metadata(COMPLETENESS, dict(completeness))
        self._end()

    def abandon(self) -> None:
        """Close the file as it was at the last flush."""
        self._stream.close_at_kept()

    def _require_no_parts(self) -> None:
        """Check that no file has the name of a part.

        Raises:
            RecordingError: There is such a file.
        """
        name = re.compile(rf"{re.escape(self._path.stem)}-\d{{3,}}{re.escape(self._path.suffix)}")
        there = sorted(path for path in self._path.parent.glob("*") if name.fullmatch(path.name))
        if there:
            raise RecordingError(
                f"{there[0]}: expected new files for the parts of a recording, but there is one; choose another name"
            )

    def _open(self) -> None:
        number = len(self.parts)
        is_split = self._split != WHOLE
        part = self._path.with_name(f"{self._path.stem}-{number:03d}{self._path.suffix}") if is_split else self._path
        self._stream = _Stream(part)
        self.parts.append(part)
        self._began = monotonic()
        self._channels: dict[tuple[str, str], int] = {}
        self._schemas: dict[str, int] = {}
        stream = cast("os.PathLike[bytes]", self._stream)
        self._writer = Writer(stream, CHUNK_BYTES, CompressionType.NONE, enable_data_crcs=True)  # type: ignore[arg-type]
        self._writer.start("legpush", f"legpush {version('legpush')}")
        self._writer.add_metadata(METADATA, {**self._about, "part": str(self._first_part + number)})
        for attachment in self._attachments.values():
            self._add(attachment)
        self._writer.flush()  # type: ignore[no-untyped-call]
        self._stream.mark_whole()

    def _end(self) -> None:
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._stream.mark_whole()
        self._stream.close_at_kept()

    def _add(self, attachment: Attachment) -> None:
        now = time_ns()
        self._writer.add_attachment(now, now, attachment.name, attachment.media_type, attachment.data)

    def _channel(self, topic: str, key: str, origin: Origin) -> int:
        channel = self._channels.get((topic, origin.incarnation))
        if channel is None:
            about = {"key": key, "role": origin.role, "name": origin.name, "incarnation": origin.incarnation}
            channel = self._writer.register_channel(topic, ENCODING, self._schema(topic), about)
            self._channels[topic, origin.incarnation] = channel
        return channel

    def _digest_channel(self) -> int:
        channel = self._channels.get((DIGEST_TOPIC, ""))
        if channel is None:
            channel = self._writer.register_channel(DIGEST_TOPIC, ENCODING, self._schema(DIGEST_TOPIC))
            self._channels[DIGEST_TOPIC, ""] = channel
        return channel

    def _schema(self, topic: str) -> int:
        """Return the id of the schema for a topic; 0 if the topic is not known."""
        kinds = _KINDS.get(topic.rpartition("/")[2], ())
        name = "Or".join(kind.__name__ for kind in kinds)
        if kinds and name not in self._schemas:
            data = json.dumps(json_schema(*kinds)).encode()
            self._schemas[name] = self._writer.register_schema(f"legpush.{name}", "jsonschema", data)
        return self._schemas.get(name, 0)


_KINDS: Final[dict[str, tuple[type[Struct], ...]]] = {
    "request": (planning.PlanRequest,),
    "cancel": (planning.PlanCancel,),
    "result": (planning.PlanResult,),
    "action": (stepping.Action,),
    "observation": (stepping.Observation, stepping.Refusal),
    "reward": (telemetry.Reward,),
    "status": (telemetry.Status,),
    "digests": (Digests,),
}
"""The types of messages, by the last segment of their topic."""


class _Stream:
    """A new file without a buffer of its own: everything written has been handed to the operating system."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, PRIVATE_FILE)
        except FileExistsError as error:
            raise RecordingError(f"{path}: expected a new file for a recording, but there is one") from error
        except OSError as error:
            raise RecordingError(f"{path}: expected a file that can be written ({error.strerror})") from error
        self.position = 0
        self._kept = 0

    def write(self, data: bytes) -> int:
        """Write all bytes.

        Raises:
            RecordingError: The file cannot be written any more.
        """
        left = memoryview(data)
        try:
            while left:
                left = left[os.write(self._file, left) :]
        except OSError as error:
            raise RecordingError(
                f"{self._path}: the recording cannot go on ({error.strerror}); its first {self._kept} bytes are kept, "
                f"`legpush recover` makes a whole file of them"
            ) from error
        self.position += len(data)
        return len(data)

    def tell(self) -> int:
        """Return the number of bytes written."""
        return self.position

    def flush(self) -> None:
        """Do nothing, since no bytes are held back."""

    def mark_whole(self) -> None:
        """Note that the file can be read up to here."""
        self._kept = self.position

    def close_at_kept(self) -> None:
        """Cut off everything after the last `mark_whole`, and close the file."""
        if self._file >= 0:
            os.ftruncate(self._file, self._kept)
            os.close(self._file)
            self._file = -1
