"""Collects what several threads send in the same moment, so that it can travel as one message."""

import threading
from collections.abc import Callable
from typing import Final

from legpush.messages.bundle import Bundle, Part

WAIT_S: Final = 0.002
"""Longest time for which a message waits for others."""
MAX_PART_BYTES: Final = 64 * 1024
"""Longest message that travels with others; a longer one gains nothing."""
MAX_BUNDLE_PARTS: Final = 64
"""With as many messages a bundle is full."""
MOST_VAIN_WAITS: Final = 64
"""Who lets as many bundles wait in vain is not expected any more: nobody knows whether a message ever comes."""


class Collector:
    """Sends the messages of several simulators as bundles.

    A bundle is sent as soon as it has a message of everyone who is expected, or is full. The thread of its first
    message waits for that, and sends the bundle as it is after `WAIT_S`.
    """

    def __init__(self, send: Callable[[Bundle], None], wait_s: float = WAIT_S) -> None:
        self._send = send
        self._wait_s = wait_s
        self._changed = threading.Condition()
        self._expected: dict[str, int] = {}
        """By name, how many bundles have waited for it in vain."""
        self._parts: list[Part] = []
        self._n_sent = 0

    def expect(self, name: str) -> None:
        """Expect a message of this simulator, or for it, soon."""
        with self._changed:
            self._expected[name] = 0

    def forget(self, name: str) -> None:
        """Expect no message of this simulator, or for it, any more."""
        with self._changed:
            self._expected.pop(name, None)

    def put(self, name: str, part: Part) -> None:
        """Send a message of this simulator, or for it, with others."""
        with self._changed:
            self._expected.pop(name, None)
            self._parts.append(part)
            number = self._n_sent
            if self._expected and len(self._parts) < MAX_BUNDLE_PARTS:
                if len(self._parts) > 1:
                    return
                self._changed.wait_for(lambda: self._n_sent != number, self._wait_s)
                if self._n_sent != number:
                    return
                self._expected = {who: n + 1 for who, n in self._expected.items() if n + 1 < MOST_VAIN_WAITS}
            bundle = Bundle(parts=tuple(self._parts))
            self._parts = []
            self._n_sent += 1
            self._changed.notify_all()
        self._send(bundle)
