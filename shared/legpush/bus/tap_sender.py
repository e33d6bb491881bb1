"""The tap of a process: copies of what it publishes, for recorders, on a path that the lockstep never waits for.

A lockstep message that blocks waits for its slowest subscriber, so recorders do not subscribe to lockstep keys. Instead
each process notes what it publishes, and a thread hands the notes to whoever records: one batch at a time, sent again
until it is taken. Without a recorder nothing is noted but how much was published.
"""

import threading
from time import monotonic
from typing import Final

from legpush.bus.tap_buffer import BATCH_BYTES, Send, TapBuffer

PERIOD_S: Final = 0.02
"""Notes are handed over this often."""
RESEND_S: Final = 0.25
"""A batch that is not taken is sent again after this long."""
MAX_SENT: Final = 8
"""So often a batch is sent; a recorder that has not taken it then goes without if another one has, and is not waited
for until it has caught up. Where half of `LIMIT_BYTES` is full, once has to do."""
PATIENCE_S: Final = 60.0
"""Without any recorder for this long, notes are thrown away, and no more are taken until one comes."""
FAREWELL_S: Final = 2.0
"""A process that ends waits so long at most for its last notes to be taken."""


class Tap:
    """Hands the notes of a buffer to recorders, on a thread that begins when the first one comes.

    `send` publishes a batch and returns it; it is called on that thread.
    """

    def __init__(self, buffer: TapBuffer, send: Send) -> None:
        self.buffer = buffer
        self._send = send
        self._changed = threading.Condition()
        self._n_recorders = 0
        self._resend_at: float | None = None
        self._n_sent = 0
        self._alone_since = monotonic()
        self._closed = False
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Take notes from now on, for a recorder that is there or about to come."""
        with self._changed:
            if self._closed:
                return
            self.buffer.start()
            self._changed.notify()
            if self._thread is None:
                self._alone_since = monotonic()
                self._thread = threading.Thread(target=self._run, name="tap", daemon=True)
                self._thread.start()

    def set_recorders(self, recorders: set[str]) -> None:
        """These incarnations record now."""
        with self._changed:
            if self.buffer.set_recorders(recorders):
                self._resend_at = None
            if self._n_recorders and not recorders:
                self._alone_since = monotonic()
            self._n_recorders = len(recorders)
            self._changed.notify()
        if recorders:
            self.start()

    def acknowledge_batch(self, recorder: str, batch: int) -> None:
        """A recorder has this batch."""
        with self._changed:
            if self.buffer.acknowledge_batch(recorder, batch):
                self._resend_at = None
                if self.buffer.n_bytes > BATCH_BYTES:
                    self._changed.notify()

    def close(self) -> None:
        """Say farewell to those who record, and wait a little until they have everything."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread is not None:
            self._thread.join()

    def _run(self) -> None:
        while not self._closed:
            with self._changed:
                # Not woken by notes: the process that publishes has other things to do than to wake this thread.
                if not self._closed:
                    self._changed.wait(PERIOD_S if self.buffer.active else None)
            self._hand_over(final=False)
        until = monotonic() + FAREWELL_S
        said = False
        while self._n_recorders and monotonic() < until and not (said and self.buffer.is_empty()):
            said = self._hand_over(final=True) or said
            with self._changed:
                self._changed.wait(PERIOD_S)

    def _hand_over(self, *, final: bool) -> bool:
        """Send the next batch, or once more the one that is not taken; whether the final one is among the sent."""
        with self._changed:
            if not self._n_recorders:
                if not final and monotonic() - self._alone_since > PATIENCE_S:
                    self.buffer.stop()
                return False
            if self._resend_at is not None and monotonic() < self._resend_at:
                return False
            is_long = self._n_sent >= MAX_SENT or (self._n_sent > 0 and self.buffer.is_filling)
            if self._resend_at is None or (is_long and self.buffer.skip_late_recorders()):
                self._n_sent = 0
            build = self.buffer.batch(final=final)
            if build is None:
                return False
            self._n_sent += 1
            self._resend_at = monotonic() + RESEND_S
        return self._send(build).final
