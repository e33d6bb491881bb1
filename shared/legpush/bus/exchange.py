"""Asks one peer and waits for its answer: resends, matches replies, detects restarts, names the peer it waits for."""

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
from legpush.errors import PeerError, PeerGoneError, StopRequestedError
from legpush.messages.common import Role
from legpush.patience import SLICE_S, Patience, Stopwatch

log = logging.getLogger(__name__)

REPORT_EVERY_S: Final = 1.0
"""How often a wait is reported, and after how long for the first time."""

OnWait = Callable[[str], None]
"""Gets a clause that names the peer and says what it is waited for; an empty one when the wait is over."""


def no_report(_: str) -> None:
    """An `OnWait` that tells nobody."""


def nobody_else() -> bool:
    """Whether another peer may be asked: none."""
    return False


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
        may_leave: Callable[[], bool] = nobody_else,
    ) -> None:
        """`may_leave` says whether another peer could be asked in the place of this one, once it is gone."""
        self._bus = bus
        self._answers = answers
        self._role, self._name = peer
        bus.follow(*peer)
        self._patience = patience
        self._stop = stop
        self._on_wait = on_wait
        self._clock = clock
        self._may_leave = may_leave
        self._peer: str | None = None
        self._accepted: dict[str, M] = {}
        """Of each incarnation that has answered, its last answer that was accepted."""
        self._rivals: frozenset[str] = frozenset()
        """The live incarnations of the peer when it was last more than one."""
        self._n_restarts = 0
        self._reported_at: float | None = None

    def ask(self, what: str, send: Callable[[], object], fits: Callable[[M], bool]) -> M:
        """Call `send` until an answer of the peer `fits`, and return that answer.

        `what` is the question in words, for messages. Time does not count while this process is paused, and starts
        again with each new incarnation of the peer.

        Raises:
            PeerError: The deadline has passed, the peer was restarted too often, or two processes have its name.
            PeerGoneError: It is gone, and another one could be asked.
            StopRequestedError: The stop event was set.
        """
        watch, rivalry, absence = (Stopwatch(self._clock) for _ in range(3))
        resend = _Resend(self._patience, self._clock)
        try:
            while not self._stop.is_set():
                live = self._bus.liveliness.live(self._role, self._name)
                chosen = self._choose(live)
                if chosen is not None:
                    if chosen.incarnation != self._peer:
                        self._meet(chosen.incarnation, what)
                        watch.restart()
                    if resend.is_due(chosen):
                        send()
                answer = self._answers.next(resend.pause_s())
                if answer is not None and self._accepts(answer, fits):
                    return answer
                if chosen is not None or not live:
                    rivalry.restart()
                if live:
                    absence.restart()
                self._check(what, watch.tick(), rivalry.tick(), absence.tick())
        finally:
            if self._reported_at is not None:
                self._reported_at = None
                self._on_wait("")
        raise StopRequestedError(f"Asked to stop while waiting for the answer to {what}; {self._state()}")

    def _check(self, what: str, waited_s: float, rivals_s: float, absent_s: float) -> None:
        """Raise where the wait has lasted too long, report where it lasts."""
        if absent_s > self._patience.leave_s and self._may_leave():
            raise PeerGoneError(f"No answer to {what}; {self._state()}")
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
            self._accepts(answer, fits)

    def _choose(self, live: list[Sighting]) -> Sighting | None:
        """The process to ask: the only live one, or of several the only one that has answered before."""
        if len(live) < 2:
            return live[0] if live else None
        incarnations = frozenset(peer.incarnation for peer in live)
        known = [peer for peer in live if peer.incarnation in self._accepted]
        if incarnations != self._rivals:
            self._rivals = incarnations
            keeping = f"; keeping to {known[0].incarnation}, which has answered before" if len(known) == 1 else ""
            log.warning("%s%s", self._state(), keeping)
        return known[0] if len(known) == 1 else None

    def _accepts(self, answer: M, fits: Callable[[M], bool]) -> bool:
        """Whether this is an answer of the peer that `fits`; any other is counted.

        What answers the present question was published after every answer to an earlier one, so a sequence that does
        not grow shows an answer of somebody else.
        """
        header = answer.header
        who = f"{header.role}/{header.name}"
        last = self._accepted.get(header.incarnation)
        if last is not None and header.sequence == last.header.sequence and answer != last:
            self._bus.tally.add("repeated", f"{who}: another answer with the sequence {header.sequence}")
            return False
        is_new = last is None or header.sequence > last.header.sequence
        if header.incarnation == self._peer and is_new and fits(answer):
            self._accepted[header.incarnation] = answer
            return True
        self._bus.tally.add("late", f"{who}: an answer that nobody waits for", logging.DEBUG)
        return False

    def forgive_restarts(self) -> None:
        """Count restarts from zero again, as the peer did what it was asked for."""
        self._n_restarts = 0

    def forget_peer(self) -> None:
        """Take the process that has the name next as if it was the first: what it does not know is no loss."""
        self._peer, self._n_restarts = None, 0

    @property
    def peer(self) -> str:
        """Role and name, for messages."""
        return f"{self._role}/{self._name}" if self._name is not None else f"the {self._role}"

    def _meet(self, incarnation: str, what: str) -> None:
        """Ask this incarnation from now on; `PeerError` if the peer was restarted too often."""
        if self._peer is not None:
            self._n_restarts += 1
            log.warning("%s was restarted during %s (%s)", self.peer, what, incarnation)
        if self._n_restarts > self._patience.max_restarts:
            raise PeerError(
                f"{self.peer} was restarted {self._n_restarts} times without an answer to {what}; giving up"
            )
        self._peer = incarnation

    def _state(self) -> str:
        return f"{self.peer} is {self._bus.liveliness.describe(self._role, self._name)}"
