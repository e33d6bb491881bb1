"""Holds the batches that wait to be recorded: each once, and within a bounded memory."""

import threading
from typing import Final

from legpush.bus.channels import Channel
from legpush.bus.ports import INBOX_SIZE, Subscription
from legpush.bus.tally import Tally
from legpush.messages.telemetry import Copies

LIMIT_BYTES: Final = 128 * 1024 * 1024
"""Refuse batches beyond this size. A sender that waits for this recorder sends them again; those of others are lost."""


class BatchInbox(Subscription[Copies]):
    """Drops a batch that is sent again while it waits; with a slow disk they would add up."""

    def __init__(self, channel: Channel[Copies], tally: Tally, limit_bytes: int = LIMIT_BYTES) -> None:
        super().__init__(channel, tally)
        self._limit_bytes = limit_bytes
        self._lock = threading.Lock()
        self._waiting: dict[tuple[str, str, int], int] = {}
        """Bytes by sender, origin and number."""
        self.n_bytes = 0
        """Total size of the waiting batches."""

    def put(self, message: Copies) -> None:
        """Take a batch from the bus, without blocking."""
        key, n_bytes = _key(message), _size(message)
        with self._lock:
            if key in self._waiting:
                return
            is_full = self._waiting and self.n_bytes + n_bytes > self._limit_bytes
            if is_full or len(self._waiting) >= INBOX_SIZE:
                limits = f"{INBOX_SIZE} batches and {self._limit_bytes} bytes"
                self._tally.add("overflow", f"{self._key}: expected at most {limits} that wait")
                return
            self._waiting[key] = n_bytes
            self.n_bytes += n_bytes
            super().put(message)

    def next(self, timeout_s: float) -> Copies | None:
        """Return the next batch, or None if none comes within `timeout_s`."""
        message = super().next(timeout_s)
        if message is not None:
            with self._lock:
                self.n_bytes -= self._waiting.pop(_key(message), 0)
        return message


def _key(batch: Copies) -> tuple[str, str, int]:
    return batch.header.incarnation, batch.origin.incarnation, batch.batch


def _size(batch: Copies) -> int:
    return sum(len(copy.payload) for copy in batch.copies) + sum(len(fact.data) for fact in batch.facts)
