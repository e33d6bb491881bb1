"""Which geoms can touch, and how their contacts are.

The robot touches whatever surrounds it, its lower legs touch each other, and the box touches floor and walls. Contacts
of feet and of the box with the floor, and of the robot with the box, are listed as pairs. Those of walls are not, as a
room may have many: the numbers of a wall hold for whatever touches it.
"""

from typing import Any, Final

_ROBOT_BIT, _SURROUNDINGS_BIT, _LOWER_LEG_BIT, _WALL_BIT = 1, 2, 4, 8

ROBOT: Final = {"contype": _ROBOT_BIT, "conaffinity": _SURROUNDINGS_BIT}
LOWER_LEG: Final = {"contype": _ROBOT_BIT | _LOWER_LEG_BIT, "conaffinity": _SURROUNDINGS_BIT | _LOWER_LEG_BIT}
FLOOR: Final = {"contype": _SURROUNDINGS_BIT, "conaffinity": _ROBOT_BIT}
BOX: Final = {"contype": _SURROUNDINGS_BIT, "conaffinity": _ROBOT_BIT | _WALL_BIT}

SOLREF: Final = (0.008, 1.0)
"""Time constant and damping ratio of contacts. On stiffer ones a box that is thrown hops, and slides as if its friction
were another one."""
FOOT_SOLREF: Final = (0.006, 1.0)
"""The same of the feet on the floor, into which they sink by less than 1 mm."""
WALL_FRICTION: Final = 0.5
"""Sliding friction coefficient of a wall with whatever touches it."""
TURNING_FRICTION_M: Final = 0.005
ROLLING_FRICTION_M: Final = 0.0001
"""Friction of turning and of rolling contacts, as in MuJoCo's defaults. Contacts have three dimensions, so they only
slide, and these do not matter."""


def contact(friction: float, *, priority: int) -> dict[str, Any]:
    """Numbers of a geom whose contacts slide with `friction`, if the geom on the other side has a lower priority."""
    return {
        "priority": priority,
        "friction": (friction, TURNING_FRICTION_M, ROLLING_FRICTION_M),
        "condim": 3,
        "solref": SOLREF,
    }


WALL: Final = {
    "contype": _SURROUNDINGS_BIT | _WALL_BIT,
    "conaffinity": _ROBOT_BIT,
    **contact(WALL_FRICTION, priority=2),
}
