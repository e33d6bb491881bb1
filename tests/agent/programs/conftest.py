"""Programs with simulators that have no physics, and with a signal that a test gives."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from agent_proc.programs import calibrate, evaluate, train
from legpush.lockstep.world import SteppingWorld
from legpush.options.learning import SimulatorOptions
from tests.agent.fake_world import FakeWorld


@contextmanager
def fake_simulators(
    options: SimulatorOptions, logs: Path, stop: threading.Event, *, kind: str, folder: Path | None = None
) -> Iterator[list[SteppingWorld]]:
    """As many worlds as the options ask for."""
    yield [FakeWorld(box_offset=(0.0, 0.03, 0.02)) for _ in range(options.n_simulators)]


@pytest.fixture
def stop(monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """The event that a signal to a program sets."""
    event = threading.Event()
    for program in (calibrate, evaluate, train):
        monkeypatch.setattr(program, "simulators", fake_simulators)
        monkeypatch.setattr(program, "stop_on_signals", lambda: event)
    return event
