"""Joint commands between the ticks of a plan: positions, velocities and torques for each step of the servos."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import CONTROL_PERIOD_S

COMMAND_PERIOD_S: Final = 0.002
"""Period at which the servos get commands: 500 Hz, as on the robot."""
COMMANDS_PER_TICK: Final = round(CONTROL_PERIOD_S / COMMAND_PERIOD_S)


@dataclass(frozen=True, kw_only=True)
class JointCommands:
    """What the servos of the twelve joints are commanded, (n, COMMANDS_PER_TICK, 12), a row per tick."""

    positions_rad: Floats
    velocities_rad_s: Floats
    torques_n_m: Floats


@dataclass(frozen=True, kw_only=True)
class Knots:
    """Positions, velocities and accelerations of the joints at the ticks of a plan, (n + 1, 12).

    The first row is where the joints are now.
    """

    positions_rad: Floats
    velocities_rad_s: Floats
    accelerations_rad_s2: Floats


def knots(now_rad: Floats, velocity_rad_s: Floats, positions_rad: Floats) -> Knots:
    """Knots from the present command (12,) and its velocity through planned positions (n, 12).

    Velocities are central differences, and a one-sided difference of second order at the last tick. Accelerations are
    central differences of the velocities, and one-sided ones of first order at both ends.
    """
    dt = CONTROL_PERIOD_S
    positions = np.concatenate([now_rad[None], positions_rad])
    velocities = np.empty_like(positions)
    velocities[0] = velocity_rad_s
    velocities[1:-1] = (positions[2:] - positions[:-2]) / (2 * dt)
    if len(positions) > 2:
        velocities[-1] = (3 * positions[-1] - 4 * positions[-2] + positions[-3]) / (2 * dt)
    else:
        velocities[-1] = (positions[-1] - positions[-2]) / dt
    accelerations = np.empty_like(positions)
    accelerations[0], accelerations[-1] = (velocities[1] - velocities[0]) / dt, (velocities[-1] - velocities[-2]) / dt
    accelerations[1:-1] = (velocities[2:] - velocities[:-2]) / (2 * dt)
    return Knots(positions_rad=positions, velocities_rad_s=velocities, accelerations_rad_s2=accelerations)


_U: Final = np.arange(COMMANDS_PER_TICK)[:, None] / COMMANDS_PER_TICK
"""Share of the tick at the beginning of each servo step, (COMMANDS_PER_TICK, 1)."""
_START, _START_SLOPE = 2 * _U**3 - 3 * _U**2 + 1, _U**3 - 2 * _U**2 + _U
_END, _END_SLOPE = 3 * _U**2 - 2 * _U**3, _U**3 - _U**2
"""The cubic Hermite basis at these shares."""
_CHANGE_RATE, _START_RATE, _END_RATE = 6 * _U**2 - 6 * _U, 3 * _U**2 - 4 * _U + 1, 3 * _U**2 - 2 * _U
"""Its derivatives."""


def interpolated(at: Knots, torques_n_m: Floats) -> JointCommands:
    """Commands between the knots: cubic Hermite positions with their velocities, and linear torques.

    `torques_n_m` (n + 1, 12) are those at the knots. A command is the value at the beginning of its step.
    """
    dt = CONTROL_PERIOD_S
    p0, p1 = at.positions_rad[:-1, None], at.positions_rad[1:, None]
    v0, v1 = at.velocities_rad_s[:-1, None] * dt, at.velocities_rad_s[1:, None] * dt
    positions = _START * p0 + _START_SLOPE * v0 + _END * p1 + _END_SLOPE * v1
    velocities = _CHANGE_RATE * (p0 - p1) + _START_RATE * v0 + _END_RATE * v1
    t0, t1 = torques_n_m[:-1, None], torques_n_m[1:, None]
    return JointCommands(positions_rad=positions, velocities_rad_s=velocities / dt, torques_n_m=t0 + _U * (t1 - t0))


def ramped(now_rad: Floats, then_rad: Floats, now_n_m: Floats, then_n_m: Floats) -> JointCommands:
    """Commands of one tick in which joints (12,) move evenly, and so do their torques (12,)."""
    velocity = (then_rad - now_rad) / CONTROL_PERIOD_S
    return JointCommands(
        positions_rad=(now_rad + _U * (then_rad - now_rad))[None],
        velocities_rad_s=np.repeat(velocity[None], COMMANDS_PER_TICK, axis=0)[None],
        torques_n_m=(now_n_m + _U * (then_n_m - now_n_m))[None],
    )
