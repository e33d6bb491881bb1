"""`legpush recover`: makes a whole recording from the rest of one that is cut off or damaged."""

from itertools import groupby
from pathlib import Path
from typing import Final

from legpush.errors import RecordingError
from legpush.files import new_file
from legpush.messages.telemetry import Origin
from legpush.recording.mcap_file.contents import Recorded, Recording
from legpush.recording.mcap_file.reader import RECOVERED_FROM, Scan
from legpush.recording.mcap_file.writer import RecordingFile

DAMAGED: Final = ".damaged"
"""Suffix for the name of a damaged file."""


def recover(path: Path, out: Path) -> Recording:
    """Write the readable messages and files of `path` to the new file `out`, which is whole or absent.

    Digests are copied as they were recorded, so that damage can still be found. A damaged file gets another name.
    `path` is not changed.

    Raises:
        RecordingError: `path` is whole, nothing in it can be read, or `out` cannot be written.
    """
    recording = Recording()
    scan = Scan(path, salvages=True)
    scan.read_into(recording)
    if scan.ended and not scan.gaps and not recording.damaged_records:
        raise RecordingError(
            f"{path}: expected a recording that is cut off or damaged, got a whole one: nothing to recover"
        )
    recording.completeness = _statement(scan, recording)
    about = {**recording.about, RECOVERED_FROM: path.name}
    try:
        with new_file(out, private=True) as scratch:
            _write(recording, RecordingFile(scratch, about, part=recording.part))
    except FileExistsError as error:
        raise RecordingError(f"{out}: expected a new file for a recording, but there is one") from error
    except (OSError, RecordingError) as error:
        cause = error if isinstance(error, OSError) else error.__cause__
        why = cause.strerror if isinstance(cause, OSError) else str(error)
        raise RecordingError(f"{out}: expected a file that can be written ({why}); nothing is left there") from error
    return recording


def _write(recording: Recording, file: RecordingFile) -> None:
    """Write the contents of a recording to a new file."""
    try:
        for attachment in recording.attachments.values():
            is_damaged = attachment.name in recording.damaged_attachments
            file.attach(attachment._replace(name=f"{attachment.name}{DAMAGED}") if is_damaged else attachment)
        for origin, messages in groupby(recording.messages, key=lambda message: message.origin):
            file.write(origin, tuple(message.copy for message in messages), recording.marks)
        file.finish(recording.completeness)
    except BaseException:
        file.abandon()
        raise


def _statement(scan: Scan, recording: Recording) -> dict[str, str]:
    """Return the statement about the completeness of the rest; the messages after the cut are not known."""
    n_missing, losses = gaps(recording.messages)
    notes = [
        f"bytes {gap.begin} to {gap.end} of {scan.size} could not be read: what was in them is missing"
        for gap in scan.gaps
    ]
    if not scan.ended:
        notes.append(f"the recording was cut off at byte {scan.position} of {scan.size}: what came after it is missing")
    notes += losses
    n_damaged = len(recording.damaged_messages())
    if n_damaged:
        notes.append(f"{n_damaged} messages were damaged before it was recovered")
    notes += [f"{words} was damaged before it was recovered" for words in recording.damaged_records]
    notes += [
        f"{name} was damaged before it was recovered, and is {name}{DAMAGED} now"
        for name in sorted(recording.damaged_attachments)
    ]
    return {
        "complete": "no",
        "n_recorded": str(len(recording.messages)),
        "n_missing": str(n_missing),
        "notes": "\n".join(notes),
    }


def gaps(messages: list[Recorded]) -> tuple[int, list[str]]:
    """Return the number of messages missing between the first and the last of each sender, and notes about them.

    Earlier messages are only noted: they may be in another part, from before the recording began, or lost.
    """
    sequences: dict[tuple[str, Origin], list[int]] = {}
    for message in messages:
        sequences.setdefault((message.topic, message.origin), []).append(message.copy.sequence)
    n_missing, losses, before = 0, [], []
    for (topic, origin), numbers in sequences.items():
        first, n_expected = min(numbers), max(numbers) + 1 - min(numbers)
        n = n_expected - len(set(numbers))
        n_missing += n
        label = f"{topic} of {origin.role} {origin.name} ({origin.incarnation})"
        if n:
            losses.append(f"{label}: {n} of {n_expected} messages are missing")
        if first:
            before.append(f"{label}: {first} messages before the first one here")
    return n_missing, [*losses, *before]
