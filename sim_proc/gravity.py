"""Gravity over a floor that may slope.

The world frame is the frame of the floor: on a slope gravity is tilted, and the floor stays level.
"""

from math import cos, radians, sin
from typing import Final

from legpush.scene import conventions
from legpush.scene.scenario import Room

GRAVITY_M_S2: Final = conventions.GRAVITY_M_S2


def gravity_m_s2(room: Room) -> tuple[float, float, float]:
    """Gravity in a room, world frame, (3,)."""
    slope, uphill = radians(room.slope_deg), radians(room.uphill_deg)
    along = 0.0 - GRAVITY_M_S2 * sin(slope)
    return along * cos(uphill) + 0.0, along * sin(uphill) + 0.0, -GRAVITY_M_S2 * cos(slope)
