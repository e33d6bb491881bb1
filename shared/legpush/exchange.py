"""Ask one peer and wait for its answer: resend, match, notice restarts, and always know whom one is waiting for."""

import logging
import threading
from collections.abc import Callable
from time import monotonic
from typing import Final, Generic

from legpush.bus import Bus, Subscription
from legpush.channels import M
from legpush.errors import PeerError, StopRequestedError
from legpush.messages import Role
from legpush.patience import SLICE_S, Patience, Stopwatch

log = logging.getLogger(__name__)

REPORT_AFTER_S: Final = 1.0
"""A wait is worth mentioning after this long."""

OnWait = Callable[[str], None]
"""Gets one clause that says who is waited for and why, and an empty one when the wait is over."""


def no_report(_: str) -> None:
    """An `OnWait` that tells nobody."""


class Exchange(Generic[M]):
    """Stop and wait with the only live peer of a role, and name if given."""

    def __init__(
        self,
        bus: Bus,
        answers: Subscription[M],
        peer: tuple[Role, str | None],
        patience: Patience,
        stop: threading.Event,
        on_wait: OnWait = no_report,
    ) -> None:
        self._bus = bus
        self._answers = answers
        self._role, self._name = peer
        self._patience = patience
        self._stop = stop
        self._on_wait = on_wait
        self._peer: str | None = None
        self._n_restarts = 0

    def ask(self, what: str, send: Callable[[], object], fits: Callable[[M], bool]) -> M:
        """Call `send` until an answer of the peer `fits`; `PeerError` past the deadline, says who and why.

        `what` is the question in words, for messages. Time does not count while this process is paused, and starts
        again with each new incarnation of the peer.
        """
        watch, rivalry = Stopwatch(), Stopwatch()
        resend_s, resend_at = self._patience.resend_s, 0.0
        reported = False
        try:
            while not self._stop.is_set():
                live = self._bus.roster.live(self._role, self._name)
                pause_s = SLICE_S
                if len(live) == 1:
                    if live[0] != self._peer:
                        self._meet(live[0], what)
                        watch.restart()
                        resend_s, resend_at = self._patience.resend_s, 0.0
                    if monotonic() >= resend_at:
                        send()
                        resend_at = monotonic() + resend_s
                        resend_s = min(2.0 * resend_s, self._patience.resend_at_most_s)
                    pause_s = min(SLICE_S, max(0.001, resend_at - monotonic()))
                answer = self._answers.next(pause_s)
                if answer is not None:
                    if answer.header.incarnation == self._peer and fits(answer):
                        return answer
                    late = f"{answer.header.role} {answer.header.name}: an answer that nobody waits for"
                    self._bus.tally.add("late", late, logging.DEBUG)
                if len(live) < 2:
                    rivalry.restart()
                elif rivalry.tick() > self._patience.rival_s:
                    raise PeerError(f"Expected one live {self.peer} for {what}, got several: {self._state()}")
                if watch.tick() > self._patience.deadline_s:
                    raise PeerError(f"No answer to {what} within {self._patience.deadline_s:g} s; {self._state()}")
                if watch.elapsed_s > REPORT_AFTER_S:
                    reported = True
                    self._on_wait(f"{what}: {self._state()}")
        finally:
            if reported:
                self._on_wait("")
        raise StopRequestedError(f"Asked to stop while waiting for the answer to {what}; {self._state()}")

    def settle(self) -> None:
        """The peer did what it was asked for: its restarts so far are forgiven."""
        self._n_restarts = 0

    @property
    def peer(self) -> str:
        """Role and name, for messages."""
        return f"{self._role} {self._name}" if self._name is not None else self._role

    def _meet(self, incarnation: str, what: str) -> None:
        """From now on this incarnation is asked; `PeerError` if it is one too many."""
        if self._peer is not None:
            self._n_restarts += 1
            log.warning("the %s was started anew during %s (%s)", self.peer, what, incarnation)
        if self._n_restarts > self._patience.max_restarts:
            raise PeerError(
                f"The {self.peer} was started anew {self._n_restarts} times without an answer to {what}; giving up"
            )
        self._peer = incarnation

    def _state(self) -> str:
        return f"the {self.peer} is {self._bus.roster.describe(self._role, self._name)}"
