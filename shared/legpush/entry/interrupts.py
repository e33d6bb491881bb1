"""What SIGINT and SIGTERM do to a program: before, during and after its work."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, Final

from legpush.errors import INTERRUPTED

SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)
RETRY_S: Final = 0.05
"""After this time an interrupt is raised again that came where it could not be raised, such as in a finalizer."""


class Interrupts:
    """Handles the signals of this process. Use it on the main thread."""

    def __init__(self) -> None:
        self.came = False
        """Whether a signal came while the program worked."""

    def leave(self, exit_code: int = INTERRUPTED) -> None:
        """Let a signal end this process at once; the signals that `hold` held back come now."""

        def on_signal(number: int, frame: FrameType | None) -> None:
            os._exit(exit_code)

        self._handle(on_signal)

    def interrupt(self) -> None:
        """Let a signal raise `KeyboardInterrupt` in the main thread."""

        def on_signal(number: int, frame: FrameType | None) -> None:
            self.came = True
            raise KeyboardInterrupt

        sys.unraisablehook = self._unraisable
        self._handle(on_signal)

    def _handle(self, handler: Callable[[int, FrameType | None], Any]) -> None:
        global _handled  # noqa: PLW0603 - signal handlers belong to the whole process
        for number in SIGNALS:
            signal.signal(number, handler)
        _handled = True
        release()

    def _unraisable(self, unraisable: "sys.UnraisableHookArgs") -> None:
        """Raise an interrupt again that Python would only print; print other errors as usual."""
        if isinstance(unraisable.exc_value, KeyboardInterrupt):
            threading.Timer(RETRY_S, os.kill, (os.getpid(), signal.SIGINT)).start()
        else:
            sys.__unraisablehook__(unraisable)


_handled = False


def are_handled() -> bool:
    """Return whether this process is a program whose signals are handled here."""
    return _handled


def release() -> None:
    """Let the signals come that `hold` held back."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)


@contextmanager
def deaf_children() -> Iterator[None]:
    """Let processes that this thread starts meanwhile be deaf to Ctrl-C in the terminal; something else ends them.

    On the main thread, a signal to this process comes afterwards, so that no process is started and then not known. A
    blocked signal alone is not enough for that, since another thread takes it.
    """
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # else the first process of `multiprocessing` starts it, which unblocks SIGINT
    came: list[int] = []
    is_main = threading.current_thread() is threading.main_thread()
    handlers = {number: signal.signal(number, lambda n, _: came.append(n)) for number in SIGNALS} if is_main else {}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        for number, handler in handlers.items():
            signal.signal(number, handler)
        if came:
            signal.raise_signal(signal.Signals(came[0]))


def hold() -> None:
    """Hold signals back until the program that this process becomes next has its handlers."""
    signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
