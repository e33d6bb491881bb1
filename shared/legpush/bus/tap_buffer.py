"""Notes of what a process published, and the batches they are handed over in; without I/O."""

import threading
from collections import deque
from collections.abc import Callable
from time import time_ns
from typing import Final

from legpush.messages import codec
from legpush.messages.common import Header
from legpush.messages.telemetry import Copies, Copy, Fact, Origin, Published

LIMIT_BYTES: Final = 64 * 1024 * 1024
"""Most bytes of notes that are kept for a recorder that is away; more are lost to it."""
BATCH_BYTES: Final = 1024 * 1024
"""A batch ends at this size."""
LARGEST_BYTES: Final = codec.MAX_MESSAGE_BYTES // 2
"""Largest message that is copied: a batch has to fit into a message itself."""
Build = Callable[[Header], Copies]
Send = Callable[[Build], Copies]


class TapBuffer:
    """Notes and batches, without I/O; safe to use from any thread."""

    def __init__(self, origin: Origin, limit_bytes: int = LIMIT_BYTES) -> None:
        self.active = False
        """Whether notes are taken."""
        self._origin = origin
        self._limit_bytes = limit_bytes
        self._lock = threading.Lock()
        self._published: dict[str, int] = {}
        self._since: dict[str, int] = {}
        """By key, the first sequence since notes are taken that is in no batch yet."""
        self._copies: deque[Copy] = deque()
        self._n_bytes = 0
        self._facts: dict[str, Fact] = {}
        self._new_facts: list[Fact] = []
        self._recorders: set[str] = set()
        self._late: set[str] = set()
        """Recorders that missed a batch, and are not waited for until they catch up."""
        self._taken_by: set[str] = set()
        self._n_batches = 0
        self._at_hand: Build | None = None

    def note_message(self, key: str, sequence: int, payload: bytes) -> None:
        """Note a message that is being published."""
        with self._lock:
            self._published[key] = sequence + 1
            if not self.active:
                return
            self._since.setdefault(key, sequence)
            if self._n_bytes + len(payload) > self._limit_bytes or len(payload) > LARGEST_BYTES:
                return
            self._n_bytes += len(payload)
            self._copies.append(Copy(key=key, sequence=sequence, time_ns=time_ns(), payload=payload))

    def attach(self, fact: Fact) -> None:
        """Hand over this file as well, in place of an earlier one of its name."""
        with self._lock:
            self._facts[fact.name] = fact
            self._new_facts.append(fact)

    def start(self) -> None:
        """Take notes from now on."""
        with self._lock:
            self.active = True

    def stop(self) -> None:
        """Throw all notes away and take no more."""
        with self._lock:
            self.active = False
            self._copies.clear()
            self._since.clear()
            self._n_bytes = 0
            self._at_hand = None

    def set_recorders(self, recorders: set[str]) -> bool:
        """Set which incarnations record now; return whether any is new and needs the batch at hand."""
        with self._lock:
            new = recorders - self._recorders
            self._recorders = set(recorders)
            self._late &= recorders
            if new:
                self._new_facts = list(self._facts.values())
            return bool(new)

    def acknowledge_batch(self, recorder: str, batch: int) -> bool:
        """Note that a recorder has this batch; whether it is the one at hand, and nobody else is waited for."""
        with self._lock:
            if batch != self._n_batches - 1:
                return False
            if recorder in self._late:
                self._late.discard(recorder)
                self._new_facts = list(self._facts.values())
            self._taken_by.add(recorder)
            if self._at_hand is None or (self._recorders - self._late or self._recorders) - self._taken_by:
                return False
            self._at_hand = None
            return True

    def skip_late_recorders(self) -> bool:
        """Give up on recorders that do not have the batch at hand, if another one has it; whether that is so.

        A skipped recorder is waited for again once it acknowledges the newest batch.
        """
        with self._lock:
            if self._at_hand is None or not self._taken_by & self._recorders:
                return False
            self._late = self._recorders - self._taken_by
            self._at_hand = None
            return True

    def batch(self, *, final: bool = False) -> Build | None:
        """The batch at hand, else a new one; None if there is nothing to hand over, unless it is the final one."""
        with self._lock:
            if self._at_hand is None and (self._copies or self._new_facts or final):
                self._at_hand = self._cut(final)
            return self._at_hand

    @property
    def n_bytes(self) -> int:
        """Size of the copies that are in no batch yet."""
        return self._n_bytes

    @property
    def is_filling(self) -> bool:
        """Whether notes may soon be lost."""
        return self._n_bytes > self._limit_bytes // 2

    def is_empty(self) -> bool:
        """Whether everything has been handed over and acknowledged."""
        with self._lock:
            return self._at_hand is None and not self._copies and not self._new_facts

    def _cut(self, final: bool) -> Build:
        """A batch of the oldest notes; it is the final one only if nothing is left behind."""
        copies: list[Copy] = []
        n_bytes = 0
        while self._copies and (not copies or n_bytes + len(self._copies[0].payload) <= BATCH_BYTES):
            copies.append(self._copies.popleft())
            n_bytes += len(copies[-1].payload)
        self._n_bytes -= n_bytes
        facts, self._new_facts = tuple(self._new_facts), []
        published = tuple(Published(key=key, n=n, since=self._since.get(key, n)) for key, n in self._published.items())
        self._since |= {copy.key: copy.sequence + 1 for copy in copies}
        number, self._n_batches, self._taken_by = self._n_batches, self._n_batches + 1, set()
        is_final = final and not self._copies

        def build(header: Header) -> Copies:
            return Copies(
                header=header,
                origin=self._origin,
                batch=number,
                copies=tuple(copies),
                published=published,
                facts=facts,
                final=is_final,
            )

        return build
