"""How late commands reach the joints, as the joint angles tell."""

from typing import Final

import numpy as np

from legpush.arrays import Floats
from sim_proc.control.joint_commands import COMMANDS_PER_TICK

LAGS: Final = np.arange(0, 85, 5)
"""Delays that are looked for, in steps of 2 ms."""
CLEAR_SHARE: Final = 0.25
"""A delay is believed if it leaves at most this share of the squared errors that no delay leaves."""


class CommandLag:
    """Compares how far joints turn in each tick with how far they were commanded to, at different times before.

    A servo that is weak, or holds a load, stays behind by an angle that hardly changes. One whose commands come late
    turns later.
    """

    def __init__(self, joints_rad: Floats, sensed_late_steps: int) -> None:
        """Begin with joints at rest, (12,), whose angles are known `sensed_late_steps` late."""
        self._sensed_late_steps = sensed_late_steps
        self._measured = joints_rad
        """The last angles."""
        self._commanded = np.repeat(joints_rad[None], int(LAGS[-1]) + sensed_late_steps + COMMANDS_PER_TICK, axis=0)
        """Positions that were commanded in the last steps, (steps, 12)."""
        self._errors_rad2: Floats = np.zeros(len(LAGS))
        self.steps = 0
        """Delay of the commands, as far as it is known."""

    @property
    def ticks(self) -> int:
        """The same in ticks."""
        return -(-self.steps // COMMANDS_PER_TICK)

    def after(self, commanded_rad: Floats, measured_rad: Floats) -> "CommandLag":
        """What is known after n ticks with commands (n, steps, 12) and joint angles at their ends (n, 12)."""
        other = CommandLag(measured_rad[-1], self._sensed_late_steps)
        n_ticks, n_past = measured_rad.shape[0], len(self._commanded)
        commanded = np.concatenate([self._commanded, commanded_rad.reshape(-1, commanded_rad.shape[-1])])
        turned = measured_rad - np.concatenate([self._measured[None], measured_rad[:-1]])
        ends = n_past + COMMANDS_PER_TICK * np.arange(1, n_ticks + 1) - 1 - self._sensed_late_steps
        then = ends[:, None] - LAGS
        errors = turned[:, None] - (commanded[then] - commanded[then - COMMANDS_PER_TICK])
        other._commanded = commanded[-n_past:]
        other._errors_rad2 = self._errors_rad2 + (errors**2).sum(axis=(0, 2))
        best = int(np.argmin(other._errors_rad2))
        if other._errors_rad2[best] < CLEAR_SHARE * other._errors_rad2[0]:
            other.steps = int(LAGS[best])
        return other

    def as_bytes(self) -> bytes:
        """All that later estimates depend on, if commands are known to be late."""
        return b"" if self.steps == 0 else self._commanded.tobytes() + self._errors_rad2.tobytes()
