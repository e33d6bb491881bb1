"""Commands that come late."""

import numpy as np
import pytest

from sim_proc.physics.delay import CommandDelay

CONTROLS = np.arange(3 * 10 * 12, dtype=float).reshape(3, 10, 12)
FIRST = np.full(12, -1.0)


def test_without_latency_nothing_waits() -> None:
    delay = CommandDelay(0.0, FIRST)
    assert delay.of_ticks(CONTROLS) is CONTROLS
    assert delay.as_bytes() == b""


@pytest.mark.parametrize("latency_s", [0.002, 0.03, 0.1])
def test_each_command_comes_late_by_the_latency(latency_s: float) -> None:
    delay, n = CommandDelay(latency_s, FIRST), round(latency_s / 0.002)
    got = np.concatenate([delay.of_ticks(CONTROLS[:1]), delay.of_ticks(CONTROLS[1:])]).reshape(-1, 12)
    expected = np.concatenate([np.repeat(FIRST[None], n, axis=0), CONTROLS.reshape(-1, 12)])[:30]
    assert (got == expected).all()


def test_step_by_step_gives_the_same_as_whole_ticks() -> None:
    whole, single = CommandDelay(0.03, FIRST), CommandDelay(0.03, FIRST)
    by_step = [row.copy() for tick in CONTROLS for row in single.one_by_one(tick)]
    assert (np.array(by_step) == whole.of_ticks(CONTROLS).reshape(-1, 12)).all()
    assert single.as_bytes() == whole.as_bytes()


def test_a_copy_waits_apart() -> None:
    delay = CommandDelay(0.03, FIRST)
    before = delay.copy()
    delay.of_ticks(CONTROLS)
    assert before.as_bytes() == CommandDelay(0.03, FIRST).as_bytes() != delay.as_bytes()
