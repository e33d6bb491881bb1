"""Which geoms can touch: the robot whatever surrounds it, and its lower legs each other."""

from typing import Final

_ROBOT_BIT, _SURROUNDINGS_BIT, _LOWER_LEG_BIT = 1, 2, 4

ROBOT: Final = {"contype": _ROBOT_BIT, "conaffinity": _SURROUNDINGS_BIT}
LOWER_LEG: Final = {"contype": _ROBOT_BIT | _LOWER_LEG_BIT, "conaffinity": _SURROUNDINGS_BIT | _LOWER_LEG_BIT}
SURROUNDINGS: Final = {"contype": _SURROUNDINGS_BIT, "conaffinity": _ROBOT_BIT}
"""Floor, walls and box."""
