"""Ask one peer and wait for its answer: resend, match, notice restarts, and always know whom one is waiting for."""

import logging
import threading
from collections.abc import Callable
from math import inf
from time import monotonic
from typing import Final, Generic

from legpush.bus.bus import Bus
from legpush.bus.channels import M
from legpush.bus.liveliness import Sighting
from legpush.bus.ports import Subscription
from legpush.errors import PeerError, StopRequestedError
from legpush.messages.common import Role
from legpush.patience import SLICE_S, Patience, Stopwatch

log = logging.getLogger(__name__)

REPORT_EVERY_S: Final = 1.0
"""A wait is worth mentioning this often, for the first time after this long."""

OnWait = Callable[[str], None]
"""Gets one clause that says who is waited for and why, and an empty one when the wait is over."""


def no_report(_: str) -> None:
    """An `OnWait` that tells nobody."""


class _Resend:
    """When a question has to be sent: at once on each new link, then again at growing intervals."""

    def __init__(self, patience: Patience, clock: Callable[[], float]) -> None:
        self._patience = patience
        self._clock = clock
        self._link: tuple[str, int] | None = None
        self._interval_s = patience.resend_s
        self._at: float | None = None

    def is_due(self, peer: Sighting) -> bool:
        """Whether to send now, to this peer; then the next interval begins."""
        link = (peer.incarnation, peer.n_links)
        if link != self._link:
            self._link, self._interval_s = link, self._patience.resend_s
        elif self._at is not None and self._clock() < self._at:
            return False
        self._at = self._clock() + self._interval_s
        self._interval_s = min(2.0 * self._interval_s, self._patience.resend_at_most_s)
        return True

    def pause_s(self) -> float:
        """How long to listen before looking around again."""
        left_s = 0.0 if self._at is None else self._at - self._clock()
        return min(SLICE_S, left_s) if left_s > 0.0 else SLICE_S


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
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self._bus = bus
        self._answers = answers
        self._role, self._name = peer
        bus.follow(*peer)
        self._patience = patience
        self._stop = stop
        self._on_wait = on_wait
        self._clock = clock
        self._peer: str | None = None
        self._n_restarts = 0
        self._reported_at: float | None = None

    def ask(self, what: str, send: Callable[[], object], fits: Callable[[M], bool]) -> M:
        """Call `send` until an answer of the peer `fits`; `PeerError` past the deadline, says who and why.

        `what` is the question in words, for messages. Time does not count while this process is paused, and starts
        again with each new incarnation of the peer.
        """
        watch, rivalry = Stopwatch(self._clock), Stopwatch(self._clock)
        resend = _Resend(self._patience, self._clock)
        try:
            while not self._stop.is_set():
                live = self._bus.liveliness.live(self._role, self._name)
                if len(live) == 1:
                    if live[0].incarnation != self._peer:
                        self._meet(live[0].incarnation, what)
                        watch.restart()
                    if resend.is_due(live[0]):
                        send()
                answer = self._answers.next(resend.pause_s())
                if answer is not None:
                    if answer.header.incarnation == self._peer and fits(answer):
                        return answer
                    self._note_late(answer)
                if len(live) < 2:
                    rivalry.restart()
                self._check(what, watch.tick(), rivalry.tick())
        finally:
            if self._reported_at is not None:
                self._reported_at = None
                self._on_wait("")
        raise StopRequestedError(f"Asked to stop while waiting for the answer to {what}; {self._state()}")

    def _check(self, what: str, waited_s: float, rivals_s: float) -> None:
        """Raise where the wait has lasted too long, report where it lasts."""
        if rivals_s > self._patience.rival_s:
            raise PeerError(f"Expected {self.peer} to be one process, to ask it for {what}; {self._state()}")
        if waited_s > self._patience.deadline_s:
            raise PeerError(f"No answer to {what} within {self._patience.deadline_s:g} s; {self._state()}")
        if waited_s >= REPORT_EVERY_S and self._clock() - (self._reported_at or -inf) >= REPORT_EVERY_S:
            self._reported_at = self._clock()
            self._on_wait(f"{what}: {self._state()}")

    def offer_answers(self, fits: Callable[[M], bool]) -> None:
        """Offer to `fits` what the peer has answered since the last question, without asking anything."""
        for answer in self._answers.drain():
            if answer.header.incarnation != self._peer or not fits(answer):
                self._note_late(answer)

    def _note_late(self, answer: M) -> None:
        late = f"{answer.header.role}/{answer.header.name}: an answer that nobody waits for"
        self._bus.tally.add("late", late, logging.DEBUG)

    def forgive_restarts(self) -> None:
        """The peer did what it was asked for: its restarts so far are forgiven."""
        self._n_restarts = 0

    @property
    def peer(self) -> str:
        """Role and name, for messages."""
        return f"{self._role}/{self._name}" if self._name is not None else f"the {self._role}"

    def _meet(self, incarnation: str, what: str) -> None:
        """From now on this incarnation is asked; `PeerError` if it is one too many."""
        if self._peer is not None:
            self._n_restarts += 1
            log.warning("%s was started anew during %s (%s)", self.peer, what, incarnation)
        if self._n_restarts > self._patience.max_restarts:
            raise PeerError(
                f"{self.peer} was started anew {self._n_restarts} times without an answer to {what}; giving up"
            )
        self._peer = incarnation

    def _state(self) -> str:
        return f"{self.peer} is {self._bus.liveliness.describe(self._role, self._name)}"
