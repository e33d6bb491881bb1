"""The simulator's end of the lockstep: every step of an episode is carried out exactly once, for one agent at a time.

For each action that comes in, one of four things happens. It is the next step: carry it out. It is the step just
done, asked again: repeat the answer. A `Reset` that opens a newer episode: carry it out. Anything else: refuse it.
"""

import logging
import threading
from collections.abc import Callable
from time import monotonic
from typing import Literal, NamedTuple

from legpush.bounds import MAX_COUNT
from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.ports import INBOX_SIZE
from legpush.bus.status import StatusBeacon
from legpush.errors import BrokenEpisodeError, LegpushError, MessageError, MotionError, ScenarioError
from legpush.lockstep.carry_out import carry_out, kind_of
from legpush.lockstep.simulator import Stepper
from legpush.messages.common import Header
from legpush.messages.stepping import Action, Motion, Observation, Outcome, Refusal, Reset
from legpush.numerics.computed_with import computing_with

log = logging.getLogger(__name__)

LOOK_S = 0.1
"""How often the stop event is checked."""
IDLE_S = 1.0
"""A simulator says that it is idle after this long without an action. A status per step would cost more than a quick
step itself.
"""

IsLive = Callable[[str, str], bool]
"""Whether the agent with this name and incarnation shows its liveliness token."""


class Denial(NamedTuple):
    """Why an action was not carried out, and which step comes next."""

    cause: Literal["out_of_step", "conflict", "invalid"]
    reason: str
    next_episode: int
    next_step: int


class Unheard(NamedTuple):
    """Why an action is neither carried out nor answered: it is not of the agent that it names."""

    cause: Literal["no_token", "repeated"]
    reason: str


class Done(NamedTuple):
    """The last step that was carried out."""

    episode: int
    step: int
    motion: Motion
    with_trace: bool
    outcome: Outcome


class Broken(NamedTuple):
    """The step in which the simulator failed, and how."""

    episode: int
    step: int
    reason: str


class StepGuard:
    """Sees that each step is carried out exactly once; works without I/O, and remembers the last step done.

    The simulator works for the agent whose action it carried out or repeated last, for as long as that agent's token
    is up.
    """

    def __init__(self, stepper: Stepper, is_live: IsLive) -> None:
        self._stepper = stepper
        self._is_live = is_live
        self._done: Done | None = None
        self._broken: Broken | None = None
        self._owner: Header | None = None
        """Of the last action that was carried out or repeated."""

    def answer(self, action: Action) -> Outcome | Denial | Unheard:
        """What the action leads to: carried out now, repeated from before, denied, or not answered at all."""
        sender, owner = action.header, self._owner
        if not self._is_live(sender.name, sender.incarnation):
            return Unheard("no_token", f"agent {sender.name} ({sender.incarnation}) shows no liveliness token")
        if owner is None or _agent(owner) == _agent(sender):
            return self._answer(action)
        if self._is_live(owner.name, owner.incarnation):
            return self._deny("conflict", f"it works for agent {owner.name} ({owner.incarnation}), which is alive")
        return self._answer(action)

    def _answer(self, action: Action) -> Outcome | Denial | Unheard:
        done = self._done
        if done is not None and (action.episode, action.step) == (done.episode, done.step):
            if (action.motion, action.with_trace) == (done.motion, done.with_trace):
                self._note_owner(action.header)
                return done.outcome
            return self._deny("conflict", f"step {done.step} was another {kind_of(done.motion)}")
        if self._broken is not None and action.episode == self._broken.episode:
            return self._deny("invalid", f"broken since step {self._broken.step}: {self._broken.reason}")
        opens = action.step == 0 and action.episode > self._episode()
        follows = done is not None and (action.episode, action.step) == (done.episode, done.step + 1)
        if not opens and not follows:
            return self._deny("out_of_step", f"got step {action.step} of episode {action.episode}")
        if opens != isinstance(action.motion, Reset):
            return self._deny(
                "invalid", f"expected a reset as step 0 alone, got {kind_of(action.motion)} as {action.step}"
            )
        owner = self._owner
        if owner is not None and _agent(owner) == _agent(action.header) and action.header.sequence <= owner.sequence:
            return Unheard("repeated", f"expected a sequence above {owner.sequence}, got {action.header.sequence}")
        return self._perform(action)

    def _perform(self, action: Action) -> Outcome | Denial:
        try:
            outcome = carry_out(self._stepper, action.motion, with_trace=action.with_trace)
        except (MotionError, ScenarioError) as error:
            return self._deny("invalid", str(error))
        except BrokenEpisodeError as error:
            return self.break_episode(action, error)
        self._broken = None
        self._done = Done(action.episode, action.step, action.motion, action.with_trace, outcome)
        self._note_owner(action.header)
        return outcome

    def break_episode(self, action: Action, error: LegpushError) -> Denial:
        """Refuse this action and all later steps of its episode, because the simulator failed in it."""
        log.error("episode %d is broken since step %d", action.episode, action.step, exc_info=error)
        self._done = None
        self._broken = Broken(action.episode, action.step, str(error))
        self._note_owner(action.header)
        return self._deny("invalid", str(error))

    def _note_owner(self, sender: Header) -> None:
        """Work for this agent from now on; a copy that was overtaken does not make its sequence lower."""
        owner = self._owner
        if owner is None or _agent(owner) != _agent(sender) or sender.sequence > owner.sequence:
            self._owner = sender

    def _episode(self) -> int:
        """The episode that a reset has to be newer than; -1 for a fresh simulator."""
        last = self._broken or self._done
        return -1 if last is None else last.episode

    def _deny(self, cause: Literal["out_of_step", "conflict", "invalid"], reason: str) -> Denial:
        if self._broken is not None:
            episode, step = min(self._broken.episode + 1, MAX_COUNT), 0
        else:
            episode, step = (0, 0) if self._done is None else (self._done.episode, self._done.step + 1)
        return Denial(cause, f"{reason}; next is step {step} of episode {episode}", episode, step)


def serve_actions(bus: Bus, stepper: Stepper, stop: threading.Event) -> None:
    """Announce this simulator and answer its actions until `stop`.

    Raises:
        RecordingError: The simulator plays a recording, and was asked for something else.
    """
    actions = bus.subscribe(channels.actions(bus.run, bus.name))
    answers = bus.publisher(channels.answers(bus.run, bus.name))
    guard = StepGuard(stepper, lambda name, incarnation: bus.liveliness.is_live("agent", name, incarnation))
    with StatusBeacon(bus, numerics=computing_with()) as beacon:
        bus.announce()
        waiting: list[Action] = []
        done, idle_since_s = "", monotonic()
        while not stop.is_set():
            if not waiting:
                first = actions.next(LOOK_S)
                if first is None:
                    if monotonic() - idle_since_s >= IDLE_S:
                        beacon.publish_status("idle", detail=done)
                    continue
                waiting = [first]
            action = waiting.pop(0)
            beacon.publish_status("stepping", detail=kind_of(action.motion))
            answer = guard.answer(action)
            if not isinstance(answer, Outcome):
                sender = action.header
                bus.tally.add(answer.cause, f"{sender.role} {sender.name}: {answer.reason}", logging.INFO)
            if not isinstance(answer, Unheard):
                try:
                    answers.send(_address(action, answer))
                except MessageError as error:
                    answers.send(_address(action, guard.break_episode(action, error)))
                others = [other for other in (*waiting, *actions.drain()) if not _same_question(other, action)]
                waiting = others[:INBOX_SIZE]
            done, idle_since_s = f"step {action.step} done", monotonic()


def _agent(header: Header) -> tuple[str, str]:
    """Name and incarnation."""
    return header.name, header.incarnation


def _same_question(one: Action, other: Action) -> bool:
    """Whether the two actions are copies. Copies that come during the execution get no answer of their own."""
    return (_agent(one.header), one.episode, one.step, one.with_trace, one.motion) == (
        _agent(other.header),
        other.episode,
        other.step,
        other.with_trace,
        other.motion,
    )


def _address(action: Action, answer: Outcome | Denial) -> Callable[[Header], Observation | Refusal]:
    """The answer as a message to the agent that asked."""

    def build(header: Header) -> Observation | Refusal:
        to, episode, step = action.header.incarnation, action.episode, action.step
        if isinstance(answer, Denial):
            return Refusal(header=header, agent_incarnation=to, episode=episode, step=step, **answer._asdict())
        return Observation(header=header, agent_incarnation=to, episode=episode, step=step, outcome=answer)

    return build
