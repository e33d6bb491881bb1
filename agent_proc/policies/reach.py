"""How far off a policy was trained: beyond that, nobody knows what it does."""

from collections.abc import Iterable
from math import degrees
from typing import Final

from msgspec import Struct

from agent_proc.frames.push_view import PushView


class Reach(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The farthest places of the box about which a policy decided while it was trained, in the frame of its goal."""

    beside_m: float
    """Largest distance from the line through the goal, to either side."""
    turned_deg: float
    """Largest angle to the heading of the goal, in either direction."""

    def __str__(self) -> str:
        """In words."""
        return f"{100 * self.beside_m:.1f} cm beside the line to its goal and turned by {self.turned_deg:.1f}°"

    def covers(self, view: PushView) -> bool:
        """Whether the box is no farther off."""
        here = reach_of(view)
        return here.beside_m <= self.beside_m and here.turned_deg <= self.turned_deg

    def widened(self, others: Iterable["Reach"]) -> "Reach":
        """The least reach that covers all of them, and what this one does."""
        all_of_them = (self, *others)
        return Reach(
            beside_m=max(each.beside_m for each in all_of_them),
            turned_deg=max(each.turned_deg for each in all_of_them),
        )


NOWHERE: Final = Reach(beside_m=0.0, turned_deg=0.0)
"""Before the first decision."""


def reach_of(view: PushView) -> Reach:
    """The least reach that covers this place of the box."""
    box = view.box_g
    return Reach(beside_m=abs(box.y_m), turned_deg=abs(degrees(box.yaw_rad)))
