"""Publishes a recording again, for recorders and viewers, at the recorded speed or another."""

import threading
from collections.abc import Sequence
from time import monotonic
from typing import Final

from legpush.bus.bus import Bus
from legpush.bus.tap_sender import Tap
from legpush.errors import RecordingError
from legpush.messages.telemetry import Fact, Origin
from legpush.recording.mcap_file.contents import Recorded, Recording

NAME_LENGTH: Final = 64


def publish(bus: Bus, recording: Recording, rate: float, start_s: float, stop: threading.Event, turn: int = 0) -> int:
    """Hand all messages from `start_s` on to recorders, in their time divided by `rate`, and return their number.

    `turn` counts the repetitions: in each of them, the processes are other incarnations.
    """
    messages = from_start(recording, start_s)
    taps: dict[str, Tap] = {}
    try:
        began, first_ns = monotonic(), messages[0].copy.time_ns
        for n, message in enumerate(messages):
            wait_s = began + (message.copy.time_ns - first_ns) / 1e9 / rate - monotonic()
            if wait_s > 0.0 and stop.wait(wait_s):
                return n
            origin = message.origin
            if origin.incarnation not in taps:
                taps[origin.incarnation] = _tap(bus, recording, origin, turn)
            taps[origin.incarnation].buffer.note_message(message.copy.key, message.copy.sequence, message.copy.payload)
    finally:
        for tap in taps.values():
            bus.taps.close_stand_in(tap)
    return len(messages)


def from_start(recording: Recording, start_s: float) -> Sequence[Recorded]:
    """Return all messages from `start_s` after the first one on, in order of time.

    Those of one sender stay in their order, even if its clock was set back.

    Raises:
        RecordingError: There are no such messages.
    """
    if not recording.messages:
        raise RecordingError("Expected a recording with messages, got one without")
    latest_ns: dict[str, int] = {}
    due_ns: list[int] = []
    for message in recording.messages:
        sender = message.origin.incarnation
        latest_ns[sender] = max(latest_ns.get(sender, 0), message.copy.time_ns)
        due_ns.append(latest_ns[sender])
    order = sorted(range(len(due_ns)), key=due_ns.__getitem__)
    messages = [recording.messages[k] for k in order]
    begin_ns = messages[0].copy.time_ns
    duration_s = (messages[-1].copy.time_ns - begin_ns) / 1e9
    if start_s > duration_s:
        raise RecordingError(
            f"Expected a --start of at most {duration_s:.1f} s, where the recording ends, got {start_s}"
        )
    return [message for message in messages if message.copy.time_ns - begin_ns >= start_s * 1e9]


def _tap(bus: Bus, recording: Recording, origin: Origin, turn: int) -> Tap:
    """Return the tap of a recorded process, with its undamaged files."""
    name = f"{origin.incarnation}-{turn}"[-NAME_LENGTH:] if turn else origin.incarnation
    tap = bus.taps.stand_in_for(Origin(role=origin.role, name=origin.name, incarnation=name))
    for attachment in recording.attachments.values():
        is_whole = attachment.name not in recording.damaged_attachments
        if is_whole and attachment.name.startswith(f"{origin.role}/{origin.name}/"):
            file = attachment.name.rpartition("/")[2]
            tap.buffer.attach(Fact(name=file, media_type=attachment.media_type, data=attachment.data))
    return tap
