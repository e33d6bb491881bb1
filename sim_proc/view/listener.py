"""Receives the messages of a live run as copies, which its processes send to every recorder."""

import queue
import threading
from time import monotonic
from typing import Final

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.ports import Publisher
from legpush.bus.status import StatusBeacon
from legpush.history.run_history import RunHistory
from legpush.messages.common import Role
from legpush.messages.telemetry import Copies, Origin, Taken
from legpush.recording.facts import scenario_in
from legpush.recording.inbox import BatchInbox
from legpush.recording.ledger import Ledger
from legpush.recording.mcap_file.writer import topic_of
from legpush.recording.recorder import taken_by
from legpush.runs.folder import SCENARIO_FILE

LOOK_S: Final = 0.05
"""Longest wait for a batch before the thread checks whether it should end."""


class Listener:
    """Acknowledges batches on a thread of its own, so that no process waits for a page; a context manager."""

    def __init__(self, bus: Bus) -> None:
        """Listen on an open bus once the context is entered."""
        self._bus = bus
        self._batches: queue.SimpleQueue[Copies] = queue.SimpleQueue()
        self._ledger = Ledger()
        self._played: dict[tuple[Role, str], tuple[Origin, str]] = {}
        """Processes that a replay plays, by role and name, each with the incarnation of the replay."""
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._listen, name="listener", daemon=True)

    def __enter__(self) -> "Listener":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._closed.set()
        self._thread.join()

    def pump(self, history: RunHistory, budget_s: float) -> None:
        """Add the batches that have arrived, for at most `budget_s`."""
        until = monotonic() + budget_s
        while monotonic() < until:
            try:
                batch = self._batches.get_nowait()
            except queue.Empty:
                return
            self.take_batch(batch, history)

    def take_batch(self, batch: Copies, history: RunHistory) -> None:
        """Add the contents of a batch."""
        if batch.header.role == "launcher":
            self._played[batch.origin.role, batch.origin.name] = (batch.origin, batch.header.incarnation)
        for fact in batch.facts:
            if fact.name == SCENARIO_FILE:
                history.scenario = scenario_in(fact.data)
        for copy in self._ledger.fresh(batch):
            history.take_message(topic_of(copy.key), batch.origin, copy)
        self._ledger.note_batch(batch, batch.copies, set())

    def live(self) -> list[Origin]:
        """Processes that are alive, or played by a replay that is alive."""
        there = [
            Origin(role=peer.role, name=peer.name, incarnation=peer.incarnation) for peer in self._bus.liveliness.live()
        ]
        incarnations = {each.incarnation for each in there}
        return there + [origin for origin, player in self._played.values() if player in incarnations]

    def _listen(self) -> None:
        """Acknowledge every batch, and pass on each batch once."""
        copies = channels.copies(self._bus.run)
        batches = self._bus.subscribe(copies, BatchInbox(copies, self._bus.tally))
        answers: dict[tuple[Role, str], Publisher[Taken]] = {}
        taken: dict[tuple[str, str], int] = {}
        with StatusBeacon(self._bus, "watching"):
            self._bus.announce()
            while not self._closed.is_set():
                batch = batches.next(LOOK_S)
                if batch is None:
                    continue
                sender = (batch.header.role, batch.header.name)
                if sender not in answers:
                    answers[sender] = self._bus.publisher(channels.taken(self._bus.run, *sender))
                answers[sender].send(taken_by(batch))
                place = (batch.header.incarnation, batch.origin.incarnation)
                if batch.batch >= taken.get(place, 0):
                    taken[place] = batch.batch + 1
                    self._batches.put(batch)
