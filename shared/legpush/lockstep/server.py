"""The simulator's end of the lockstep: every step of an episode is carried out exactly once.

For each action that comes in, one of four things happens. It is the next step: carry it out. It is the step just
done, asked again: repeat the answer. A `Reset` that opens a newer episode: carry it out. Anything else: refuse it.
"""

import logging
import threading
from collections.abc import Callable
from typing import Literal, NamedTuple

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.status import StatusBeacon
from legpush.errors import MotionError, ScenarioError
from legpush.lockstep.simulator import Stepper
from legpush.messages.common import Header
from legpush.messages.stepping import Action, Motion, Observation, Outcome, Refusal, Reset

log = logging.getLogger(__name__)

IDLE_S = 0.1
"""How often the stop event is checked."""


class Denial(NamedTuple):
    """Why an action was not carried out, and which step comes next."""

    cause: Literal["out_of_step", "conflict", "invalid"]
    reason: str
    next_episode: int
    next_step: int


class Done(NamedTuple):
    """The last step that was carried out."""

    episode: int
    step: int
    motion: Motion
    with_trace: bool
    outcome: Outcome


class StepGuard:
    """Sees that each step is carried out exactly once; works without I/O, and remembers the last step done."""

    def __init__(self, stepper: Stepper) -> None:
        self._stepper = stepper
        self._done: Done | None = None

    def answer(self, action: Action) -> Outcome | Denial:
        """What the action leads to: carried out now, repeated from before, or denied."""
        done = self._done
        if done is not None and (action.episode, action.step) == (done.episode, done.step):
            if (action.motion, action.with_trace) == (done.motion, done.with_trace):
                return done.outcome
            return self._deny("conflict", f"step {done.step} was another {_kind(done.motion)}")
        opens = action.step == 0 and (done is None or action.episode > done.episode)
        follows = done is not None and (action.episode, action.step) == (done.episode, done.step + 1)
        if not opens and not follows:
            return self._deny("out_of_step", f"got step {action.step} of episode {action.episode}")
        if opens != isinstance(action.motion, Reset):
            return self._deny(
                "invalid", f"expected a reset as step 0 alone, got {_kind(action.motion)} as {action.step}"
            )
        return self._perform(action)

    def _perform(self, action: Action) -> Outcome | Denial:
        try:
            outcome = self._stepper.perform(action.motion, with_trace=action.with_trace)
        except (MotionError, ScenarioError) as error:
            return self._deny("invalid", str(error))
        self._done = Done(action.episode, action.step, action.motion, action.with_trace, outcome)
        return outcome

    def _deny(self, cause: Literal["out_of_step", "conflict", "invalid"], reason: str) -> Denial:
        episode, step = (0, 0) if self._done is None else (self._done.episode, self._done.step + 1)
        return Denial(cause, f"{reason}; next is step {step} of episode {episode}", episode, step)


def serve_actions(bus: Bus, stepper: Stepper, stop: threading.Event) -> None:
    """Announce this simulator and answer its actions until `stop`; an error of the physics is raised."""
    actions = bus.subscribe(channels.actions(bus.run, bus.name))
    answers = bus.publisher(channels.answers(bus.run, bus.name))
    guard = StepGuard(stepper)
    with StatusBeacon(bus) as beacon:
        bus.announce()
        waiting: list[Action] = []
        while not stop.is_set():
            if not waiting:
                first = actions.next(IDLE_S)
                if first is None:
                    continue
                waiting = [first]
            action = waiting.pop(0)
            beacon.publish_status("stepping", detail=_kind(action.motion))
            answer = guard.answer(action)
            if isinstance(answer, Denial):
                bus.tally.add(answer.cause, f"{action.header.role} {action.header.name}: {answer.reason}", logging.INFO)
            answers.send(_address(action, answer))
            waiting = [other for other in (*waiting, *actions.drain()) if not _same_question(other, action)]
            beacon.publish_status("idle", detail=f"step {action.step} done")


def _same_question(one: Action, other: Action) -> bool:
    """Whether the two actions are copies. Copies that come during the execution get no answer of their own."""
    return (one.header.incarnation, one.episode, one.step, one.with_trace, one.motion) == (
        other.header.incarnation,
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


def _kind(motion: Motion) -> str:
    return type(motion).__name__.lower()
