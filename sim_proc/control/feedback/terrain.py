"""The floor as the feet find it: where it is not level, feet step higher, and the trunk follows their mean height."""

from math import ceil
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.robot import RobotSpec
from sim_proc.control.swing import APEX_SHARE, quintic

ALONG_FROM: Final = 0.25
ALONG_UNTIL: Final = 0.85
"""Shares of the flight in which a foot moves along the floor: first it rises, and it comes down at its place."""
SLOW_TICKS: Final = 2
"""Ticks that a leg takes to slow down."""


class Terrain:
    """Knows whether the floor is rough, and how a foot steps there."""

    def __init__(self, robot: RobotSpec) -> None:
        """Begin on a level floor."""
        self._numbers, self._touchdown_m, self._height_m = robot.rough, robot.touchdown_m, robot.stance.height_m
        self.rough = False
        """Whether a foot stands higher or lower than on the level floor."""
        self.apex_ticks = ceil(APEX_SHARE * robot.rough.flight_ticks)
        """Ticks of a swing on a rough floor in which the foot rises."""
        self.slow_from_tick = robot.rough.flight_ticks + SLOW_TICKS
        """Tick from which on it moves slowly enough to tell that something stops the leg."""
        self.back_m = robot.rough.back_m
        """How much nearer a foot steps if an edge holds its leg."""

    def feel(self, feet_m: Floats, *, missed: bool) -> None:
        """Look at where the feet stand, (4, 3), and whether the last one has missed its place."""
        self.rough = missed or bool((np.abs(feet_m[:, 2] - self._touchdown_m) > self._numbers.from_m).any())

    def has_missed(self, foot_m: Floats, target_m: Floats) -> bool:
        """Whether a foot, (3,), is down far from its place, (2,)."""
        return float(np.linalg.norm(foot_m[:2] - target_m)) > self._numbers.missed_m

    def trunk_height_m(self, feet_m: Floats) -> float:
        """Height of the trunk above feet (4, 3)."""
        return self._height_m + float(feet_m[:, 2].mean()) - self._touchdown_m if self.rough else self._height_m

    def least_heights_m(self, feet_m: Floats, leg: int) -> Floats | None:
        """Heights below which feet (4, 3) have slipped off an edge, (4,), all but a leg that steps."""
        if not self.rough:
            return None
        heights: Floats = feet_m[:, 2] - self._numbers.slip_m
        heights[leg] = -np.inf
        return heights

    def swing(self, feet_m: Floats, leg: int, target_m: Floats) -> Floats:
        """The curve of a foot to a place, (2,), from where all feet are, (4, 3); one point per tick, (n, 3).

        The foot rises above the highest one, moves along, and comes down fast to just above the highest foot. From
        there on it comes down slowly to below the lowest one, and is to be stopped by the floor.
        """
        numbers, start, flight = self._numbers, feet_m[leg], self._numbers.flight_ticks
        highest, lowest = float(feet_m[:, 2].max()), float(feet_m[:, 2].min())
        apex_m, near_m = highest + numbers.step_height_m, highest + numbers.near_m
        per_tick_m = numbers.descent_m_s * CONTROL_PERIOD_S
        slow = np.arange(1, ceil((near_m - lowest + numbers.below_m) / per_tick_m) + 1)
        tick = np.arange(1, flight + 1)
        along = quintic(np.clip((tick / flight - ALONG_FROM) / (ALONG_UNTIL - ALONG_FROM), 0.0, 1.0))
        rising = quintic(np.minimum(tick / self.apex_ticks, 1.0))
        falling = quintic(np.clip((tick - self.apex_ticks) / (flight - self.apex_ticks), 0.0, 1.0))
        curve = np.empty((flight + len(slow), 3))
        curve[:flight, :2] = start[:2] + along[:, None] * (target_m - start[:2])
        curve[:flight, 2] = start[2] + (apex_m - start[2]) * rising + (near_m - apex_m) * falling
        curve[flight:, :2], curve[flight:, 2] = target_m, near_m - per_tick_m * slow
        return curve
