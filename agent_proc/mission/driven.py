"""A mission that is driven from outside: it stops where it asks its policy for a push, and goes on with the answer.

`run_mission` is a loop that calls its world and its policy. Here it runs in a thread of its own that only thinks: each
call becomes a question, and the thread waits for its answer. One of the two threads runs at any time, so a driven
mission is the same as any other. The world is called by the thread that drives, in which Ctrl-C arrives.
"""

import threading
import weakref
from collections.abc import Callable
from dataclasses import dataclass, field
from queue import SimpleQueue
from typing import Any, TypeVar, cast

from agent_proc.endings import MissionResult
from agent_proc.frames.push_view import PushView
from agent_proc.mission.mission import run_mission
from legpush.errors import ConfigError
from legpush.lockstep.world import World
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome, Push
from legpush.scene.scenario import Scenario

Value = TypeVar("Value")


class DrivenMission:
    """A mission, from its reset up to the push that it asks for, and on from there."""

    view: PushView | None = None
    """What the mission asks about; None once it is over."""
    result: MissionResult | None = None
    """How it ended; None if it goes on, or was abandoned."""

    def __init__(self, world: World, scenario: Scenario, seed: int) -> None:
        """Run the mission up to the first push that it asks for, if there is one.

        Raises:
            LegpushError: What `run_mission` raises.
        """
        self._world = world
        self._line = _Line()
        # A daemon, since a mission that nobody ends must not keep its process from ending.
        thread = threading.Thread(target=_think, args=(self._line, scenario, seed), name="mission", daemon=True)
        self.abandon = weakref.finalize(self, _abandon, self._line, thread)
        """Ends the mission where it is, and its thread."""
        thread.start()
        self._drive()

    def answer(self, push: Push | None) -> None:
        """Give the mission the push that it asked for, or None to stop, and run it up to the next one.

        After an error or an interruption, the mission is abandoned.

        Raises:
            ConfigError: The mission asks for nothing.
            LegpushError: What `run_mission` raises.
        """
        if self.view is None:
            raise ConfigError("Expected a mission that asks for a push, got one that is over")
        self._line.answers.put(_Answer(push))
        self._drive()

    def _drive(self) -> None:
        """Do what the mission asks of its world until it asks for a push or is over."""
        self.view = None
        try:
            while isinstance(question := self._line.questions.get(), _Call):
                self._line.answers.put(self._carried_out(question))
        except BaseException:
            self.abandon()
            raise
        if isinstance(question, PushView):
            self.view = question
            return
        self.abandon()
        if isinstance(question, BaseException):
            raise question
        self.result = question

    def _carried_out(self, call: "_Call") -> "_Answer":
        """Call the world; an error is the mission's, which knows what it means."""
        try:
            return _Answer(call.do(self._world))
        except Exception as error:  # noqa: BLE001 - raised again in the other thread
            return _Answer(error=error)


@dataclass(frozen=True)
class _Call:
    """A question to the world."""

    do: Callable[[World], Any]


@dataclass(frozen=True)
class _Answer:
    """An answer to a question: a value, or the error to raise."""

    value: Any = None
    error: BaseException | None = None


@dataclass(frozen=True)
class _Line:
    """What connects the mission with the thread that drives it."""

    questions: "SimpleQueue[_Call | PushView | MissionResult | BaseException]" = field(default_factory=SimpleQueue)
    """Calls of the world, views to decide about, and at last how the mission ended."""
    answers: SimpleQueue[_Answer] = field(default_factory=SimpleQueue)
    abandoned: threading.Event = field(default_factory=threading.Event)

    def ask(self, question: _Call | PushView) -> Any:
        """Ask the thread that drives, and wait for its answer.

        Raises:
            _AbandonedError: Nobody drives the mission any more.
        """
        if self.abandoned.is_set():
            raise _AbandonedError
        self.questions.put(question)
        answer = self.answers.get()
        if answer.error is not None:
            raise answer.error
        return answer.value


class _AbandonedError(BaseException):
    """Ends a mission that nobody drives any more; no error, so that nothing on the way handles it."""


class _AskingWorld:
    """A `World` that asks for every answer."""

    def __init__(self, line: _Line) -> None:
        self._line = line

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Carry out one motion."""
        return self._call(lambda world: world.step(motion, with_trace=with_trace))

    def tell_reward(self, terms: Any) -> None:
        """Publish what a step earned."""
        self._call(lambda world: world.tell_reward(terms))

    def plan(self, query: PlanQuery) -> Plan:
        """Return the first answer to a query."""
        return self._call(lambda world: world.plan(query))

    def revision(self, revision: int) -> Plan:
        """Return a better answer to the last query."""
        return self._call(lambda world: world.revision(revision))

    def cancel_plan(self) -> None:
        """End the search for better answers."""
        self._call(lambda world: world.cancel_plan())

    def _call(self, do: Callable[[World], Value]) -> Value:
        return cast(Value, self._line.ask(_Call(do)))


class _AskingPolicy:
    """A policy that asks about every push."""

    def __init__(self, line: _Line) -> None:
        self._line = line

    def decide(self, view: PushView) -> Push | None:
        """Ask."""
        return cast(Push | None, self._line.ask(view))


def _think(line: _Line, scenario: Scenario, seed: int) -> None:
    """Run the mission; the thread that drives gets its result or its error."""
    try:
        line.questions.put(run_mission(_AskingWorld(line), scenario, seed, _AskingPolicy(line)))
    except _AbandonedError:
        return
    except BaseException as error:  # noqa: BLE001 - raised again in the other thread
        line.questions.put(error)


def _abandon(line: _Line, thread: threading.Thread) -> None:
    """End the thread at its next question, or in the one whose answer it waits for."""
    line.abandoned.set()
    line.answers.put(_Answer(error=_AbandonedError()))
    # The garbage collector calls this wherever it runs, even in that thread.
    if thread.ident is not None and thread is not threading.current_thread():
        thread.join()
