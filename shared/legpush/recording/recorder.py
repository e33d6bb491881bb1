"""The recorder: takes the copies that processes hand over, writes them to a file, and states how complete it is."""

import logging
import threading
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from time import monotonic
from typing import Final

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.ports import Publisher
from legpush.bus.status import StatusBeacon
from legpush.messages.common import Header, Role
from legpush.messages.telemetry import Copies, Origin, Taken
from legpush.recording.inbox import BatchInbox
from legpush.recording.ledger import Completeness, Ledger
from legpush.recording.mcap_file.writer import Attachment, RecordingFile, topic_of

log = logging.getLogger(__name__)

FLUSH_S: Final = 0.5
"""Period of writing to the file. A kill of the recorder loses at most this much, besides messages on their way."""
LOOK_S: Final = 0.05
GATHER_S: Final = 3.0
"""After a request to stop, longest time to wait for processes to end and say farewell."""
FAREWELL_S: Final = 2.0
"""The same, for a process that has already exited."""
COPIED: Final[tuple[Role, ...]] = ("planner", "sim", "agent")
"""The roles whose messages are recorded."""


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """What to record."""

    topics: tuple[str, ...] = ()
    """Patterns of topics, such as `sim/*`; without any, all topics."""
    duration_s: float | None = None

    def takes(self, key: str) -> bool:
        """Return whether messages under this key are recorded."""
        topic = topic_of(key)
        return not self.topics or any(fnmatchcase(topic, pattern) for pattern in self.topics)


class Recorder:
    """Writes batches to a file; the caller receives them from the bus."""

    def __init__(self, file: RecordingFile, wanted: Wanted) -> None:
        self._file = file
        self._wanted = wanted
        self.ledger = Ledger()
        self.n_recorded = 0

    def write_batch(self, batch: Copies) -> None:
        """Write the messages of a batch that are new."""
        if not self.ledger.is_new(batch):
            return
        copies = tuple(copy for copy in self.ledger.fresh(batch) if self._wanted.takes(copy.key))
        self.ledger.note_batch(batch, copies, {each.key for each in batch.published if self._wanted.takes(each.key)})
        origin = batch.origin
        for fact in batch.facts:
            self._file.attach(Attachment(f"{origin.role}/{origin.name}/{fact.name}", fact.media_type, fact.data))
        self._file.write(origin, copies)
        self.n_recorded += len(copies)


def record(bus: Bus, file: RecordingFile, wanted: Wanted, stop: threading.Event) -> Completeness:
    """Record until `stop` is set, or for the wanted duration.

    Raises:
        RecordingError: The file cannot be written any more.
    """
    copies = channels.copies(bus.run)
    batches = bus.subscribe(copies, BatchInbox(copies, bus.tally))
    answers: dict[tuple[Role, str], Publisher[Taken]] = {}
    recorder = Recorder(file, wanted)
    began = flushed_at = monotonic()
    stopped_at: float | None = None
    seen_at: dict[str, float] = {}
    with StatusBeacon(bus, "recording") as beacon:
        bus.announce()
        log.info("recording to %s", file.parts[0])
        while True:
            now = monotonic()
            if stopped_at is None and (stop.is_set() or now - began > (wanted.duration_s or float("inf"))):
                stopped_at = now
            batch = batches.next(LOOK_S)
            if batch is not None:
                recorder.write_batch(batch)
                sender = (batch.header.role, batch.header.name)
                if sender not in answers:
                    answers[sender] = bus.publisher(channels.taken(bus.run, *sender))
                answers[sender].send(taken_by(batch))
            if now - flushed_at >= FLUSH_S:
                file.flush()
                flushed_at = now
                beacon.publish_status("recording", detail=f"{recorder.n_recorded} messages")
            peers = _peers(bus)
            live = {origin.incarnation for origin in peers}
            for origin in peers:
                recorder.ledger.note_process(origin)
            seen_at |= dict.fromkeys(live, now)
            if stopped_at is None:
                continue
            # A process takes its token down before it says farewell. Wait for processes with a token only after a
            # signal, since a launcher sends it to all processes at once.
            gone_at = {each: seen_at.get(each, began) for each in recorder.ledger.unfinished()}
            expected = {each for each, at in gone_at.items() if now - at < FAREWELL_S}
            if (batch is None and not (expected if stop.is_set() else expected - live)) or now - stopped_at > GATHER_S:
                break
    completeness = recorder.ledger.completeness(live)
    file.finish(statement(completeness))
    return completeness


def statement(completeness: Completeness) -> dict[str, str]:
    """Return the metadata about the completeness of a recording."""
    return {
        "complete": "yes" if completeness.complete else "no",
        "n_recorded": str(completeness.n_recorded),
        "n_missing": str(completeness.n_missing),
        "notes": "\n".join(completeness.notes),
    }


def taken_by(batch: Copies) -> Callable[[Header], Taken]:
    """Return a function that makes the message which tells the sender of a batch that it is recorded."""
    origin, number = batch.origin.incarnation, batch.batch
    return lambda header: Taken(header=header, origin_incarnation=origin, batch=number)


def _peers(bus: Bus) -> list[Origin]:
    live = bus.liveliness.live()
    return [Origin(role=p.role, name=p.name, incarnation=p.incarnation) for p in live if p.role in COPIED]
