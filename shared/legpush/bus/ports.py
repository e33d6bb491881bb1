"""Publishers and subscriptions: what a process sends messages with, and takes them from."""

import queue
import threading
from collections.abc import Callable
from typing import Final, Generic

from legpush.bus.channels import Channel, M
from legpush.bus.tally import Tally
from legpush.messages import codec
from legpush.messages.common import Header

INBOX_SIZE: Final = 1024
"""Most messages that wait in a subscription; more are refused, so that a flood cannot fill the memory."""


class Publisher(Generic[M]):
    """Sends the messages of one channel, each with the next header."""

    def __init__(
        self,
        header: Callable[[int], Header],
        send: Callable[[bytes], None],
        note: Callable[[int, bytes], None] | None = None,
    ) -> None:
        """`note` is told sequence and bytes of each message before it is sent."""
        self._header = header
        self._send = send
        self._note = note
        self._sequence = 0
        self._lock = threading.Lock()

    def send(self, build: Callable[[Header], M]) -> M:
        """Send what `build` makes of the header that it is given.

        Raises:
            MessageError: The message is too large, or holds a number that is not finite.
        """
        with self._lock:
            message = build(self._header(self._sequence))
            payload = codec.encode(message)
            if self._note is not None:
                self._note(self._sequence, payload)
            self._sequence += 1
            self._send(payload)
        return message


class Subscription(Generic[M]):
    """The valid messages of one channel, in the order in which they came."""

    def __init__(self, channel: Channel[M], tally: Tally) -> None:
        self._key = channel.key
        self._tally = tally
        self._inbox: queue.SimpleQueue[M] = queue.SimpleQueue()

    def put(self, message: M) -> None:
        """Called by the bus, on one thread per channel; never blocks."""
        if self._inbox.qsize() < INBOX_SIZE:
            self._inbox.put(message)
        else:
            self._tally.add("overflow", f"{self._key}: expected at most {INBOX_SIZE} waiting messages")

    def next(self, timeout_s: float) -> M | None:
        """The next message, or None if none comes within `timeout_s`; 0 looks without waiting."""
        try:
            return self._inbox.get(block=timeout_s > 0.0, timeout=timeout_s)
        except queue.Empty:
            return None

    def drain(self) -> list[M]:
        """All messages that are waiting, without waiting for more."""
        messages = []
        while (message := self.next(0.0)) is not None:
            messages.append(message)
        return messages
