"""Gusts: horizontal forces on the trunk that begin and end between ticks."""

from math import atan2, ceil, cos, sin
from typing import Final

from legpush.realism.reality import Gust, Reality
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.headless import mujoco

NEVER: Final = 2**62
"""A tick that no episode reaches."""
ROUNDING_TICKS: Final = 1e-6
"""A time this close above a whole number of ticks counts as that number."""


class GustSchedule:
    """The gusts of an episode. They depend on nothing but its numbers and, for their direction, on the trunk."""

    def __init__(self, reality: Reality, trunk_body: int) -> None:
        """Push the body with the index `trunk_body`."""
        self._reality, self._trunk = reality, trunk_body
        self._gusts: list[Gust] = []
        """Those that are known so far, in their order; the last one has not begun."""
        self._n_added = 0
        self._add()

    def begin_run(self, tick: int) -> None:
        """Forget the gusts that ended before a tick, to which the simulation does not come back."""
        self._gusts = [gust for gust in self._gusts[:-1] if _ticks(gust)[1] >= tick] + self._gusts[-1:]

    def next_change(self, tick: int) -> int:
        """The first tick after `tick` at whose beginning a gust begins or ends; `NEVER` if there is none."""
        self._know_until(tick)
        return min((each for gust in self._gusts for each in _ticks(gust) if each > tick), default=NEVER)

    def blow(self, data: mujoco.MjData, tick: int) -> None:
        """Let the gusts begin and end that do so at the beginning of a tick."""
        self._know_until(tick)
        ends, still = False, False
        for gust in self._gusts:
            first, end = _ticks(gust)
            ends, still = ends or end == tick, still or first <= tick < end
            if first == tick:
                forward = data.xmat[self._trunk].reshape(3, 3)[:2, 0]
                direction = atan2(forward[1], forward[0]) + gust.direction_rad
                data.xfrc_applied[self._trunk, :2] = [gust.force_n * cos(direction), gust.force_n * sin(direction)]
        if ends and not still:
            data.xfrc_applied[self._trunk, :2] = 0.0

    def _know_until(self, tick: int) -> None:
        """Know all gusts that begin up to a tick, and the one after them."""
        while self._gusts and _ticks(self._gusts[-1])[0] <= tick and self._add():
            pass

    def _add(self) -> bool:
        """Add the next gust; returns whether there is one."""
        index = self._n_added
        before_s = self._gusts[-1].begins_s if self._gusts else 0.0
        begins_s = self._reality.gust_begins_s(index, before_s)
        if begins_s is None:
            return False
        self._n_added += 1
        self._gusts.append(self._reality.gust(index, begins_s))
        return True


def _ticks(gust: Gust) -> tuple[int, int]:
    """The ticks at whose beginning a gust begins and ends."""
    first = ceil(gust.begins_s / CONTROL_PERIOD_S - ROUNDING_TICKS)
    return first, first + ceil(gust.duration_s / CONTROL_PERIOD_S - ROUNDING_TICKS)
