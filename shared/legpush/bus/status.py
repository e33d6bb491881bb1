"""What this process is doing, published about once per second for people, and for peers that wait for it."""

import threading
from math import inf
from time import monotonic
from types import TracebackType
from typing import Final, Self

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.messages.common import Header
from legpush.messages.telemetry import Status

PERIOD_S: Final = 1.0
SHORTEST_PERIOD_S: Final = 0.1
"""Changes that follow faster than this are published as one."""

Said = tuple[str, float | None, str, str]
"""Phase, fraction, detail, waiting for."""


class StatusBeacon:
    """Publishes the status of a process: when it changes, and every `PERIOD_S` as a heartbeat, on its own thread."""

    def __init__(self, bus: Bus, phase: str = "idle", numerics: str = "") -> None:
        """Begin with `phase`. A simulator says with which `numerics` it computes."""
        self._numerics = numerics
        self._publisher = bus.publisher(channels.statuses(bus.run, bus.role, bus.name))
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._beat, name="status", daemon=True)
        self._said: Said = (phase, None, "", "")
        self._published: Said | None = None
        self._published_at = -inf

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._closed.set()
        self._thread.join()

    def publish_status(
        self, phase: str, fraction: float | None = None, detail: str = "", waiting_for: str = ""
    ) -> None:
        """Publish that the process is in this `phase`, of which `fraction` is done if known.

        A change is sent before this returns, so that it is out before a library that holds the interpreter is called;
        if the last one was sent less than `SHORTEST_PERIOD_S` ago, the heartbeat sends it.
        """
        self._said = (phase, fraction, detail, waiting_for)
        if self._said != self._published and monotonic() - self._published_at >= SHORTEST_PERIOD_S:
            self._publish()

    def _beat(self) -> None:
        while not self._closed.wait(SHORTEST_PERIOD_S):
            if self._said != self._published or monotonic() - self._published_at >= PERIOD_S:
                self._publish()

    def _publish(self) -> None:
        self._published_at, self._published = monotonic(), self._said
        self._publisher.send(self._status)

    def _status(self, header: Header) -> Status:
        phase, fraction, detail, waiting_for = self._published or self._said
        return Status(
            header=header,
            phase=phase,
            fraction=fraction,
            detail=detail,
            waiting_for=waiting_for,
            numerics=self._numerics,
        )
