"""Lockstep steps with a stub: all are counted, and one that is lost or done twice is found."""

import threading
from pathlib import Path

import pytest

from legpush.errors import DivergedError
from legpush.soak import steps
from legpush.soak.steps import EPISODE_STEPS, run_steps
from legpush.soak.stub_simulator import chained


def test_the_steps_are_done_over_episodes_and_reported(tmp_path: Path) -> None:
    seen: list[int] = []
    result = run_steps(EPISODE_STEPS + 200, tmp_path, threading.Event(), seen.append)
    assert result.n_steps == seen[-1] == EPISODE_STEPS + 200
    assert set(result.growth) == {"agent", "sim"}
    assert all(growth is not None and growth.threads == 0 for growth in result.growth.values())


def test_they_end_early_when_asked_to_stop(tmp_path: Path) -> None:
    stop = threading.Event()
    result = run_steps(10_000, tmp_path, stop, lambda n_done: stop.set())
    assert 0 < result.n_steps < 10_000


def test_another_state_than_that_of_the_steps_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    honest = chained
    monkeypatch.setattr(steps, "chained", lambda crc, motion: honest(crc + (crc != 0), motion))
    with pytest.raises(DivergedError, match="after step 1"):
        run_steps(100, tmp_path, threading.Event())
