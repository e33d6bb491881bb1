"""How late commands are, from joints that follow them."""

import numpy as np
import pytest

from legpush.arrays import Floats
from sim_proc.control.joint_commands import COMMANDS_PER_TICK
from sim_proc.estimation.command_lag import CommandLag

REST = np.linspace(-0.5, 0.5, 12)
N_TICKS = 40


def moved(late_steps: int, sensed_late_steps: int) -> tuple[Floats, Floats]:
    """Commands (n, steps, 12) that set out from rest, and joint angles at the ends of their ticks, (n, 12).

    The joints follow late, stay behind a little, and are measured late and with noise.
    """
    at_s = 0.002 * np.arange(N_TICKS * COMMANDS_PER_TICK)
    commands = REST + 0.1 * (1.0 - np.cos(np.linspace(6.0, 12.0, 12) * at_s[:, None]))
    before = np.repeat(REST[None], late_steps + sensed_late_steps, axis=0)
    followed = REST + 0.97 * (np.concatenate([before, commands])[: len(commands)] - REST)
    noise = np.random.default_rng(0).normal(scale=0.0005, size=(N_TICKS, 12))
    measured = followed[COMMANDS_PER_TICK - 1 :: COMMANDS_PER_TICK] + noise
    return commands.reshape(N_TICKS, COMMANDS_PER_TICK, 12), measured


@pytest.mark.parametrize(("late_steps", "ticks"), [(0, 0), (15, 2), (30, 3), (50, 5), (80, 8)])
@pytest.mark.parametrize("sensed_late_steps", [0, 10, 33])
@pytest.mark.parametrize("parts", [[40], [16, 24], [1] * 40])
def test_a_delay_is_known_however_old_the_angles_are_and_in_whatever_runs_they_come(
    late_steps: int, ticks: int, sensed_late_steps: int, parts: list[int]
) -> None:
    commands, measured = moved(late_steps, sensed_late_steps)
    lag, tick = CommandLag(REST, sensed_late_steps), 0
    for n in parts:
        lag = lag.after(commands[tick : tick + n], measured[tick : tick + n])
        tick += n
    assert (lag.steps, lag.ticks) == (late_steps, ticks)
    assert (lag.as_bytes() == b"") == (late_steps == 0)


def test_what_may_come_is_looked_at_without_being_taken_in() -> None:
    commands, measured = moved(50, 10)
    lag = CommandLag(REST, 10)
    assert lag.after(commands, measured).steps == 50
    assert lag.steps == 0
    assert lag.after(commands, measured).as_bytes() == lag.after(commands, measured).as_bytes()


def test_a_robot_that_stands_knows_of_no_delay() -> None:
    commands = np.tile(REST, (N_TICKS, COMMANDS_PER_TICK, 1))
    noise = np.random.default_rng(0).normal(scale=0.0005, size=(N_TICKS, 12))
    assert CommandLag(REST, 10).after(commands, REST + noise).steps == 0
