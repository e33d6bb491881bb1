"""How far off a policy was trained: beyond that, nobody knows what it does."""

from collections.abc import Iterable
from math import degrees
from typing import Final

import numpy as np
from msgspec import Struct

from agent_proc.frames.push_view import PushView

SHARE: Final = 0.99
"""Of all decisions of a training, those that its reach covers in each quantity. The rest are first attempts."""
STEP_M: Final = 0.01
STEP_DEG: Final = 1.0
N_STEPS: Final = 180
"""Widths and number of the steps in which places are counted; the last one has all that are farther off."""


class Reach(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far off the box was for nearly all decisions of a training, in the frame of its goal."""

    beside_m: float
    """Distance from the line through the goal, to either side."""
    turned_deg: float
    """Angle to the heading of the goal, in either direction."""

    def __str__(self) -> str:
        """In words."""
        return f"{100 * self.beside_m:.1f} cm beside the line to its goal and turned by {self.turned_deg:.1f}°"

    def covers(self, view: PushView) -> bool:
        """Whether the box is no farther off."""
        here = reach_of(view)
        return here.beside_m <= self.beside_m and here.turned_deg <= self.turned_deg


class Visits(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How often the box was how far off when a policy in training decided."""

    beside: tuple[int, ...] = (0,) * N_STEPS
    turned: tuple[int, ...] = (0,) * N_STEPS
    """Counts, by steps of `STEP_M` and `STEP_DEG`."""

    def with_views(self, views: Iterable[PushView]) -> "Visits":
        """The same with a decision more about each of the views."""
        beside, turned = list(self.beside), list(self.turned)
        for here in map(reach_of, views):
            beside[min(int(here.beside_m / STEP_M), N_STEPS - 1)] += 1
            turned[min(int(here.turned_deg / STEP_DEG), N_STEPS - 1)] += 1
        return Visits(beside=tuple(beside), turned=tuple(turned))

    @property
    def reach(self) -> Reach:
        """What covers `SHARE` of the decisions, in each quantity."""
        return Reach(beside_m=STEP_M * _n_steps(self.beside), turned_deg=STEP_DEG * _n_steps(self.turned))


def reach_of(view: PushView) -> Reach:
    """The least reach that covers this place of the box."""
    box = view.box_g
    return Reach(beside_m=abs(box.y_m), turned_deg=abs(degrees(box.yaw_rad)))


def _n_steps(counts: tuple[int, ...]) -> int:
    """The number of first steps that have `SHARE` of the counts."""
    up_to = np.cumsum(counts)
    return int(np.searchsorted(up_to, SHARE * up_to[-1])) + 1
