"""An episode that survives its agent: what was answered before comes from the journal, what is new from the peers."""

import logging
from collections.abc import Callable, Mapping
from typing import Protocol

from legpush.errors import DivergedError, JournalError, LegpushError, MotionError
from legpush.history.entries import Acted, Awaited, Entry, Numbered, Observed, Opened, Planned, Queried, Refused
from legpush.history.journal import Journal, cannot_go_on, read_entries
from legpush.history.steps import words_of
from legpush.lockstep.client import PastStep, SimLink
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Alter, Motion, Outcome
from legpush.numerics.computed_with import ComputedWith, computed_with, told
from legpush.plans.client import PlanLink

log = logging.getLogger(__name__)


class Past(Protocol):
    """Answers to the first steps of an episode, and to the plan queries among them, from elsewhere."""

    n_steps: int
    """Number of steps that are answered."""
    alter: Alter | None
    """Carried out where the past ends, before anything new."""
    computed_with: ComputedWith
    """What it was computed with."""
    still: str
    """What can be done with it if it is of another version."""

    def act(self, step: int, motion: Motion, *, with_trace: bool) -> Outcome:
        """Return what the motion leads to as this step, with its trace if that is known.

        Raises:
            MotionError: It was refused.
        """

    def plan(self, query: PlanQuery) -> Plan:
        """The answer to a query."""

    def revision(self, query: PlanQuery, revision: int) -> Plan:
        """A better one."""


class Episode:
    """A `World` on the bus that is remembered: `step` moves it and `plan` asks for a path, nothing else does either.

    With a journal that already holds entries, the first calls are answered from it. The mission that runs again has to
    ask the very same things, which it does if it depends on the answers alone; then it goes on live where it ended.
    """

    def __init__(self, journal: Journal, sim: SimLink, planner: PlanLink, past: Past | None = None) -> None:
        """With a `past` the episode continues another one: the simulator is led through its steps."""
        self._journal = journal
        self._origin = past
        self._redoes = False
        """Whether the simulator has been led into that past, and so has to go through the rest of it."""
        self._sim = sim
        self._planner = planner
        self._past: list[PastStep] = []
        self._number: int | None = None
        self._recorded = read_entries(journal.path)
        self._n_entries = 0
        self._query: PlanQuery | None = None
        self.live = False
        """Whether the journal has been used up, and answers come from the peers."""

    @property
    def n_steps(self) -> int:
        """How many steps were carried out."""
        return len(self._past)

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Return what the motion leads to.

        Raises:
            MotionError: The motion cannot be carried out; the state is as it was.
        """
        origin = self._origin
        if origin is not None and origin.alter is not None and self.n_steps == origin.n_steps:
            self._step(origin.alter, with_trace=True)
        return self._step(motion, with_trace=with_trace)

    def _step(self, motion: Motion, *, with_trace: bool) -> Outcome:
        answer = self._answer(
            Acted(motion=motion, with_trace=with_trace), lambda: self._act(motion, with_trace=with_trace)
        )
        if isinstance(answer, Refused):
            raise MotionError(answer.reason)
        if not isinstance(answer, Observed):
            raise self._mismatch("an answer to an action", answer)
        self._past.append(PastStep(motion, answer.outcome.state_crc))
        return answer.outcome

    def plan(self, query: PlanQuery) -> Plan:
        """The planner's answer."""
        answer = self._answer(Queried(query=query), lambda: Planned(plan=self._plan(query)))
        if not isinstance(answer, Planned):
            raise self._mismatch("a plan", answer)
        self._query = query
        return answer.plan

    def revision(self, revision: int) -> Plan:
        """A better plan for the last query, the one with this number."""
        answer = self._answer(Awaited(revision=revision), lambda: Planned(plan=self._revision(revision)))
        if not isinstance(answer, Planned):
            raise self._mismatch("a better plan", answer)
        return answer.plan

    def cancel_plan(self) -> None:
        """No better plans for the last query are waited for any more."""
        self._planner.cancel()

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        """Let people know what the last step earned, unless it is told from the journal."""
        if self.live and self._past and self._sim.episode == self._number:
            self._sim.tell_reward(len(self._past) - 1, terms)

    def _answer(self, question: Acted | Queried | Awaited, ask: Callable[[], Entry]) -> Entry:
        """The recorded answer to the question, or the live one, which is recorded."""
        recorded = self._take()
        if recorded is None:
            self._journal.append(question)
        elif recorded != question:
            raise self._mismatch(words_of(question), recorded)
        answer = self._take()
        if answer is None:
            answer = ask()
            self._journal.append(answer)
        return answer

    def _plan(self, query: PlanQuery) -> Plan:
        origin = self._origin_now()
        return self._planner.plan(query) if origin is None else origin.plan(query)

    def _revision(self, revision: int) -> Plan:
        origin = self._origin_now()
        if origin is None or self._query is None:
            return self._planner.revision(revision, self._query)
        return origin.revision(self._query, revision)

    def _origin_now(self) -> Past | None:
        """Who answers instead of the peers, if anybody does yet."""
        return self._origin if self._origin is not None and self.n_steps < self._origin.n_steps else None

    def _act(self, motion: Motion, *, with_trace: bool) -> Observed | Refused:
        answer: Observed | Refused
        origin = self._origin_now()
        try:
            known = None if origin is None else origin.act(self.n_steps, motion, with_trace=with_trace)
            if known is not None and not self._redoes and (known.trace is not None or not with_trace):
                return Observed(outcome=known)
            self._redoes = True
            answer = Observed(outcome=self._simulate(motion, known, with_trace=with_trace))
        except MotionError as error:
            answer = Refused(reason=str(error))
        if self._sim.episode != self._number:
            self._note_number()
        return answer

    def _simulate(self, motion: Motion, known: Outcome | None, *, with_trace: bool) -> Outcome:
        """Return the simulator's outcome of the next step, which has to be the known one, if there is one."""
        try:
            outcome = self._sim.step(motion, self._past, with_trace=with_trace)
        except DivergedError as error:
            raise self._told(error) from error
        if known is not None and known.state_crc != outcome.state_crc:
            difference = (
                f"Expected state {known.state_crc:08x} after step {self.n_steps}, as recorded, got "
                f"{outcome.state_crc:08x} from sim/{self._sim.sim}: it computes something else"
            )
            raise self._told(DivergedError(difference))
        return outcome

    def _take(self) -> Entry | None:
        """The next recorded question or answer; None from the end of the journal on."""
        if self.live:
            return None
        for entry in self._recorded:
            self._n_entries += 1
            if isinstance(entry, Numbered):
                self._number = entry.episode
            elif not isinstance(entry, Opened):
                return entry
        self._go_live()
        return None

    def _go_live(self) -> None:
        self.live = True
        if self._past:
            log.info("%s: %d steps taken from the journal, going on live", self._journal.path, len(self._past))
        if self._sim.begin(self._number) != self._number:
            self._note_number()

    def _note_number(self) -> None:
        self._number = self._sim.episode
        self._journal.append(Numbered(episode=self._number))

    def _mismatch(self, expected: str, got: Entry) -> LegpushError:
        return self._told(
            JournalError(
                f"{self._journal.path}: expected {expected} as entry {self._n_entries - 1}, got {words_of(got)}, "
                f"at step {self.n_steps}; the journal is of another mission, or the mission does not depend on its "
                "answers alone"
            )
        )

    def _told(self, error: LegpushError) -> LegpushError:
        """Return a difference as one of versions or numerics, if it comes from these."""
        if self._origin is not None:
            return told(error, self._origin.computed_with, self._origin.still)
        still = cannot_go_on(self._journal.path.parent)
        return told(error, computed_with(self._journal.opened.versions), still)
