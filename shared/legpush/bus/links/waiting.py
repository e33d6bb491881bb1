"""Waits for a router without being deaf to signals: Zenoh opens the session of a client only where a router is."""

import logging
import threading
from collections.abc import Callable
from time import monotonic
from typing import Final, Generic, TypeVar

from legpush.bus.endpoints import listing
from legpush.errors import StopRequestedError

AGAIN_S: Final = 0.2
LAST_S: Final = 1.0
"""An attempt may take this long to end after a stop."""
TELL_S: Final = 10.0
"""A router that is still not there is told about this often."""

log = logging.getLogger(__name__)

T = TypeVar("T")


class NobodyThereError(Exception):
    """No router can be reached now; says what happened."""


def open_when_there(open_once: Callable[[], T], routers: tuple[str, ...], stop: threading.Event) -> T:
    """Call `open_once` until it no longer raises `NobodyThereError`, and return what it returns.

    It runs on a thread of its own, because Zenoh may take ten seconds for a host that does not answer, and signals are
    handled on the main thread.

    Raises:
        StopRequestedError: `stop` is set before a router is there.
    """
    told_s, why = monotonic() - TELL_S, ""
    while True:
        attempt = _Attempt(open_once)
        while attempt.is_running:
            if stop.is_set():
                # A thread that comes back from Zenoh while Python ends would abort the process.
                attempt.wait(LAST_S)
            _require_no_stop(stop, routers)
        try:
            return attempt.result()
        except NobodyThereError as error:
            if str(error) != why or monotonic() - told_s >= TELL_S:
                told_s, why = monotonic(), str(error)
                log.warning("waiting for a router at %s: %s", listing(routers), why)
        if stop.wait(AGAIN_S):
            _require_no_stop(stop, routers)


def _require_no_stop(stop: threading.Event, routers: tuple[str, ...]) -> None:
    if stop.is_set():
        raise StopRequestedError(f"interrupted while waiting for a router at {listing(routers)}")


class _Attempt(Generic[T]):
    """A call on a thread of its own."""

    def __init__(self, call: Callable[[], T]) -> None:
        self._call = call
        self._results: list[T] = []
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="router", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            self._results.append(self._call())
        except Exception as error:  # noqa: BLE001 - it is raised where the result is asked for
            self._error = error

    @property
    def is_running(self) -> bool:
        """Whether it has not ended; waits a moment for that."""
        self.wait(0.05)
        return self._thread.is_alive()

    def wait(self, timeout_s: float) -> None:
        """Wait until it has ended, but no longer than this."""
        self._thread.join(timeout_s)

    def result(self) -> T:
        """Return what the call returned, or raise its error."""
        if self._error is not None:
            raise self._error
        return self._results[0]
