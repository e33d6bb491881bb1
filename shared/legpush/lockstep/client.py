"""The agent's end of the lockstep: stop and wait, and bring a simulator that came back to where the episode is."""

import logging
import threading
from collections.abc import Mapping, Sequence
from functools import partial
from time import time_ns
from typing import NamedTuple, Protocol

from legpush.bounds import MAX_COUNT
from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.exchange import Exchange, OnWait, no_report
from legpush.bus.ports import Publisher
from legpush.errors import BrokenEpisodeError, DivergedError, MotionError, PeerError, PeerGoneError
from legpush.messages.common import Header
from legpush.messages.stepping import Action, Answer, Motion, Outcome, Refusal
from legpush.messages.telemetry import Reward, RewardTerm
from legpush.patience import Patience, Stopwatch

log = logging.getLogger(__name__)


class PastStep(NamedTuple):
    """A step that was carried out, and the state it led to."""

    motion: Motion
    state_crc: int


class Spares(Protocol):
    """Simulators that nobody asks yet."""

    def any(self) -> bool:
        """Return whether there is one."""
        ...

    def take(self, lost: str) -> str | None:
        """Return the name of one that is asked in the place of `lost` from now on; None if there is none any more."""
        ...


class NoSpares:
    """There is one simulator, and what takes its name is in its place."""

    def any(self) -> bool:
        """Return whether there is one."""
        return False

    def take(self, _: str) -> None:
        """Return None, as there is none."""


class _End(NamedTuple):
    """What a link has for one simulator."""

    exchange: Exchange[Answer]
    actions: Publisher[Action]
    rewards: Publisher[Reward]


class SimLink:
    """Asks one simulator by name, one action at a time; one that is gone is replaced by a spare one.

    Episodes are numbered by the clock when they begin, in milliseconds, so that two agents never mean different
    episodes by one number, and a later episode has the higher number.
    """

    def __init__(
        self,
        bus: Bus,
        sim: str,
        *,
        stop: threading.Event,
        patience: Patience | None = None,
        on_wait: OnWait = no_report,
        spares: Spares | None = None,
    ) -> None:
        self._bus = bus
        self._stop = stop
        self._patience = patience or Patience()
        self._on_wait = on_wait
        self._spares = spares or NoSpares()
        self._ends: dict[str, _End] = {}
        """By the name of the simulator; one that was left may be needed again."""
        self._ask_from_now_on(sim)
        self._in_step: str | None = None
        self.episode = -1

    def _ask_from_now_on(self, sim: str) -> None:
        self.sim = sim
        if sim not in self._ends:
            bus = self._bus
            self._ends[sim] = _End(
                exchange=Exchange(
                    bus,
                    bus.subscribe(channels.answers(bus.run, sim)),
                    ("sim", sim),
                    self._patience,
                    self._stop,
                    self._on_wait,
                    may_leave=self._spares.any,
                ),
                actions=bus.publisher(channels.actions(bus.run, sim)),
                rewards=bus.publisher(channels.rewards(bus.run, sim)),
            )

    @property
    def _exchange(self) -> Exchange[Answer]:
        return self._ends[self.sim].exchange

    def begin(self, episode: int | None = None) -> int:
        """Begin a new episode, or go on with the one that has this number; returns the number.

        Raises:
            PeerError: No episode can have a number that is this high.
        """
        number = max(self.episode + 1, time_ns() // 1_000_000) if episode is None else episode
        if number > MAX_COUNT:
            raise PeerError(
                f"{self._exchange.peer} is in the last episode that has a number, {MAX_COUNT}: expected a simulator "
                "that can begin another one, so start it again"
            )
        self._in_step = None
        self.episode = number
        return number

    def step(self, motion: Motion, past: Sequence[PastStep], *, with_trace: bool = False) -> Outcome:
        """What `motion` leads to as the step after `past`, all of the episode's steps up to now.

        A simulator that does not have the state after `past` is led there by doing it all again, each state checked.

        Raises:
            MotionError: The simulator cannot carry the motion out.
            BrokenEpisodeError: It failed in this motion, or in one of `past`.
            PeerError: It does not answer, or refuses the step.
            DivergedError: It computes something else than before.
        """
        led: set[str] = set()
        while True:
            answer = self._ask_in_turn(len(past), motion, with_trace)
            if not isinstance(answer, Refusal):
                self._in_step = answer.header.incarnation
                self._exchange.forgive_restarts()
                return answer.outcome
            if answer.cause == "invalid":
                raise self._invalid(len(past), answer)
            if answer.header.incarnation in (self._in_step, *led):
                asking = "; is another agent using it?" if answer.cause == "out_of_step" else ""
                raise PeerError(f"{self._exchange.peer} refuses step {len(past)}: {answer.reason}{asking}")
            led.add(answer.header.incarnation)
            self._lead(past, answer)

    def tell_reward(self, step: int, terms: Mapping[str, float]) -> None:
        """Let people know what a step of the present episode earned, term by term."""
        episode = self.episode

        def build(header: Header) -> Reward:
            return Reward(
                header=header,
                sim=self.sim,
                episode=episode,
                step=step,
                value=sum(terms.values()),
                terms=tuple(RewardTerm(name=name, value=value) for name, value in terms.items()),
            )

        self._ends[self.sim].rewards.send(build)

    def _lead(self, past: Sequence[PastStep], refusal: Refusal) -> None:
        """Bring the simulator that refused to the state after `past`, in an episode that is new to it."""
        self.begin(max(self.begin(), refusal.next_episode + 1))
        for index, step in enumerate(past):
            answer = self._ask_in_turn(index, step.motion, with_trace=False)
            if isinstance(answer, Refusal):
                if self._is_broken(answer):
                    raise self._invalid(index, answer)
                if answer.cause == "invalid" or (answer.cause == "conflict" and index == 0):
                    raise PeerError(f"{self._exchange.peer} refuses step {index} of the journal: {answer.reason}")
                return
            self._in_step = answer.header.incarnation
            if answer.outcome.state_crc != step.state_crc:
                raise DivergedError(
                    f"Expected state {step.state_crc:08x} after step {index} of the journal, got "
                    f"{answer.outcome.state_crc:08x} from {self._exchange.peer}: it computes something else"
                )
        if past:
            log.info("%s was led through %d steps again, state %08x", self._exchange.peer, len(past), past[-1][1])

    def _invalid(self, step: int, refusal: Refusal) -> MotionError | BrokenEpisodeError:
        """What a refusal as `invalid` means."""
        kind = BrokenEpisodeError if self._is_broken(refusal) else MotionError
        return kind(f"Step {step}: {refusal.reason}")

    def _is_broken(self, refusal: Refusal) -> bool:
        """Whether the simulator failed in this episode, so that it expects a later one."""
        return refusal.cause == "invalid" and refusal.next_episode > self.episode

    def _ask_in_turn(self, step: int, motion: Motion, with_trace: bool) -> Answer:
        """Ask for a step; while the simulator works for another agent, wait for a while until that one is gone.

        An agent that was killed may still show as live for a lease.
        """
        waited = Stopwatch()
        while True:
            answer = self._ask(step, motion, with_trace)
            if not isinstance(answer, Refusal) or answer.cause != "conflict":
                return answer
            if waited.tick() > self._patience.rival_s:
                return answer
            self._stop.wait(self._patience.resend_s)

    def _ask(self, step: int, motion: Motion, with_trace: bool) -> Answer:
        episode = self.episode

        def build(header: Header) -> Action:
            return Action(header=header, episode=episode, step=step, motion=motion, with_trace=with_trace)

        def fits(answer: Answer) -> bool:
            return (answer.agent_incarnation, answer.episode, answer.step) == (self._bus.incarnation, episode, step)

        what = f"step {step} ({type(motion).__name__.lower()})"
        while True:
            end = self._ends[self.sim]
            try:
                return end.exchange.ask(what, partial(end.actions.send, build), fits)
            except PeerGoneError as gone:
                spare = self._spares.take(self.sim)
                if spare is not None:
                    log.warning("%s. Its place takes sim/%s.", gone, spare)
                    self._ask_from_now_on(spare)
