"""What this process is doing, published about once per second for people, and for peers that wait for it."""

import threading
from types import TracebackType
from typing import Final, Self

from legpush import channels
from legpush.bus import Bus
from legpush.messages import Header, Status

PERIOD_S: Final = 1.0
SHORTEST_PERIOD_S: Final = 0.1
"""Changes that follow faster than this are published as one."""


class StatusBeacon:
    """Publishes the last `say` at once, and again every `PERIOD_S` as a heartbeat, on a thread of its own."""

    def __init__(self, bus: Bus, phase: str = "idle") -> None:
        self._publisher = bus.publisher(channels.statuses(bus.run, bus.role, bus.name))
        self._changed = threading.Event()
        self._closed = threading.Event()
        self._said: tuple[str, float | None, str, str] = (phase, None, "", "")
        self._thread = threading.Thread(target=self._publish, name="status", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._closed.set()
        self._changed.set()
        self._thread.join()

    def say(self, phase: str, fraction: float | None = None, detail: str = "", waiting_for: str = "") -> None:
        """From now on the process is in this `phase`, done to `fraction` where known; never blocks."""
        said = (phase, fraction, detail, waiting_for)
        if said != self._said:
            self._said = said
            self._changed.set()

    def _publish(self) -> None:
        while not self._closed.is_set():
            self._changed.clear()
            self._publisher.send(self._status)
            self._changed.wait(PERIOD_S)
            self._closed.wait(SHORTEST_PERIOD_S)

    def _status(self, header: Header) -> Status:
        phase, fraction, detail, waiting_for = self._said
        return Status(header=header, phase=phase, fraction=fraction, detail=detail, waiting_for=waiting_for)
