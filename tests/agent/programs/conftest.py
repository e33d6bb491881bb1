"""Programs with simulators that have no physics, and with a signal that a test gives."""

import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest

from agent_proc.programs import evaluate, measure_parts, train
from legpush.lockstep.world import SteppingWorld
from legpush.messages.stepping import Motion, Outcome, Reset
from legpush.options.learning import SimulatorOptions
from tests.agent.fake_world import FakeWorld


@contextmanager
def fake_simulators(
    options: SimulatorOptions, logs: Path, stop: threading.Event, *, kind: str, folder: Path | None = None
) -> Iterator[list[SteppingWorld]]:
    """As many worlds as the options ask for."""
    yield [FakeWorld(box_offset=(0.0, 0.03, 0.02)) for _ in range(options.n_simulators)]


class StoppingWorld(FakeWorld):
    """Sets an event when it is reset for the n-th time."""

    def __init__(self, stop: threading.Event, n: int) -> None:
        super().__init__(box_offset=(0.0, 0.03, 0.02))
        self._stop = stop
        self._n = n

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Step as without it."""
        self._n -= isinstance(motion, Reset)
        if self._n == 0:
            self._stop.set()
        return super().step(motion, with_trace=with_trace)


def stopping(stop: threading.Event, n_finished: int) -> Callable[..., AbstractContextManager[list[SteppingWorld]]]:
    """In the place of `simulators`: one world in which the user interrupts after so many resets."""

    @contextmanager
    def simulators(*_: object, **__: object) -> Iterator[list[SteppingWorld]]:
        yield [StoppingWorld(stop, n_finished + 1)]

    return simulators


@pytest.fixture
def stop(monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """The event that a signal to a program sets."""
    event = threading.Event()
    for program in (evaluate, measure_parts, train):
        monkeypatch.setattr(program, "simulators", fake_simulators)
        monkeypatch.setattr(program, "stop_on_signals", lambda: event)
    return event
