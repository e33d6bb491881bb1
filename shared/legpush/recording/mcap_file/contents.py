"""Everything in a recording, and what of it is damaged."""

from dataclasses import dataclass, field
from pathlib import Path

from legpush.errors import RecordingError
from legpush.messages import codec
from legpush.messages.telemetry import Copy, Origin
from legpush.recording.digests import Key, Mark
from legpush.recording.mcap_file.writer import Attachment


@dataclass(frozen=True, kw_only=True, slots=True)
class Recorded:
    """A message of a recording."""

    topic: str
    origin: Origin
    copy: Copy

    @property
    def place(self) -> str:
        """Name of the message in texts for people."""
        return f"{self.topic} of {self.origin.role} {self.origin.name}, sequence {self.copy.sequence}"


@dataclass(kw_only=True)
class Recording:
    """Everything in a recording."""

    about: dict[str, str] = field(default_factory=dict)
    """The metadata from its beginning."""
    completeness: dict[str, str] = field(default_factory=dict)
    """The statement of its recorder at the end; empty if the recorder did not finish."""
    messages: list[Recorded] = field(default_factory=list)
    """In the order in which they came to the recorder, which keeps the order of each sender."""
    attachments: dict[str, Attachment] = field(default_factory=dict)
    damaged_attachments: set[str] = field(default_factory=set)
    """Names of attachments whose bytes are not those that were recorded."""
    marks: dict[Key, Mark] = field(default_factory=dict)
    """The digests of messages when they were recorded."""
    files: list[Path] = field(default_factory=list)
    """In the order of the parts, even if they were given in another order."""
    part: int = 0
    """Number of the first file among the parts of its recording."""
    damaged_records: list[str] = field(default_factory=list)
    """Records of the files with a flipped bit, in words for people: chunks, indexes, the summary."""

    @property
    def is_complete(self) -> bool:
        """Whether the recorder stated so, and the recording has as many messages as it stated."""
        return self.completeness.get("complete") == "yes" and self.n_lost == 0

    @property
    def n_lost(self) -> int:
        """Number of recorded messages that cannot be read: the file is damaged, or parts of it are missing."""
        said = self.completeness.get("n_recorded", "")
        return max(0, int(said) - len(self.messages)) if said.isdecimal() else 0

    def damaged_messages(self) -> list[Recorded]:
        """Return the messages whose bytes are not those that were recorded."""
        return [message for message in self.messages if not self.is_as_recorded(message)]

    def attachment(self, name: str) -> Attachment | None:
        """Return the first file of this name, from any process.

        Raises:
            RecordingError: The file is damaged.
        """
        found = next((a for a in self.attachments.values() if a.name.rpartition("/")[2] == name), None)
        if found is not None and found.name in self.damaged_attachments:
            raise RecordingError(
                f"{found.name} of the recording is damaged: its bytes are not those that were recorded"
            )
        return found

    def mark(self, message: Recorded) -> Mark | None:
        """Return the digest of a message when it was recorded; None if there is no digest."""
        return self.marks.get((message.topic, message.origin.incarnation, message.copy.sequence))

    def is_as_recorded(self, message: Recorded) -> bool:
        """Return whether the bytes of a message are those that were recorded; True if there is no digest."""
        mark = self.mark(message)
        return mark is None or mark.crc == codec.checksum(message.copy.payload)
