"""The load on each foot at every physics step: which feet are loaded, when they touch down, and how fast."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats, Indices
from legpush.scene.conventions import LEGS, LOADED_N
from legpush.scene.robot import RobotSpec
from sim_proc.gravity import GRAVITY_M_S2
from sim_proc.model.world import PHYSICS_STEP_S

LOADED_SHARE: Final = 0.048
UNLOADED_SHARE: Final = 0.016
"""Shares of the robot's weight above which a foot becomes loaded, and below which it no longer is: 15 and 5 N of 312 N.

A foot that trembles between the two keeps its state, so that contacts that flicker count once.
"""
FLIGHT_S: Final = 0.06
"""Least time in the air before a landing. A foot that bounces comes back sooner."""


@dataclass(frozen=True, kw_only=True)
class Loads:
    """Loads of the feet in n physics steps."""

    loaded: Flags
    """Whether each foot is loaded, (n, 4)."""
    n_touchdowns: int
    """How often the force on a foot rose above `LOADED_N`."""
    n_loadings: int
    """How often a foot became loaded."""
    landing_speeds_m_s: Floats
    """Downward speed of the foot in the last step before each landing, (k,)."""


class LoadWatch:
    """Follows the loads of the feet from motion to motion."""

    def __init__(self, robot: RobotSpec) -> None:
        """Begin with all feet in the air for a long time."""
        weight_n = robot.mass_kg * GRAVITY_M_S2
        self._on_n, self._off_n = LOADED_SHARE * weight_n, UNLOADED_SHARE * weight_n
        self._flight_steps = round(FLIGHT_S / PHYSICS_STEP_S)
        self._loaded: Flags = np.zeros(len(LEGS), dtype=bool)
        self._touching: Flags = np.zeros(len(LEGS), dtype=bool)
        self._last_touch: Indices = np.full(len(LEGS), -self._flight_steps - 1)
        """The last step in which each foot touched the floor, relative to the first step of the next motion, (4,)."""
        self._heights_m: Floats | None = None
        """Heights of the feet in the last step, (4,); None before the first."""

    def take(self, forces_n: Floats, heights_m: Floats) -> Loads:
        """Follow vertical forces on the feet, and heights of their centres, (n, 4) each, through the next n steps."""
        n = len(forces_n)
        loaded = self._with_hysteresis(forces_n)
        before = self._shifted(loaded, self._loaded)
        touching = forces_n >= LOADED_N
        touched_before = self._shifted(touching, self._touching)
        touchdowns = touching & ~touched_before
        steps, feet = touchdowns.nonzero()
        last = np.where(touching, np.arange(n)[:, None], self._last_touch)
        np.maximum.accumulate(last, axis=0, out=last)
        previous = np.concatenate([self._last_touch[None], last])[steps, feet]
        landed = steps - previous > self._flight_steps
        above = heights_m[:1] if self._heights_m is None else self._heights_m[None]
        heights = np.concatenate([above, heights_m])
        falls = (heights[steps, feet] - heights[steps + 1, feet])[landed] / PHYSICS_STEP_S
        self._loaded, self._touching = loaded[-1].copy(), touching[-1].copy()
        self._last_touch, self._heights_m = last[-1] - n, heights_m[-1].copy()
        return Loads(
            loaded=loaded,
            n_touchdowns=len(steps),
            n_loadings=int(np.count_nonzero(loaded & ~before)),
            landing_speeds_m_s=falls,
        )

    def _with_hysteresis(self, forces_n: Floats) -> Flags:
        """Whether each foot is loaded, (n, 4): the state is that of the last step outside the two thresholds."""
        on = forces_n > self._on_n
        known = on | (forces_n < self._off_n)
        at = np.where(known, np.arange(1, len(forces_n) + 1)[:, None], 0)
        np.maximum.accumulate(at, axis=0, out=at)
        states = np.concatenate([self._loaded[None], on])
        loaded: Flags = np.take_along_axis(states, at, axis=0)
        return loaded

    @staticmethod
    def _shifted(flags: Flags, first: Flags) -> Flags:
        """Flags of the steps before, (n, 4); those before the first step are given."""
        return np.concatenate([first[None], flags[:-1]])
