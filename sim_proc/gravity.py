"""Gravity over a floor that may slope.

The world frame is the frame of the floor: on a slope gravity is tilted, and the floor stays level.
"""

from math import atan, atan2, cos, hypot, radians, sin, tan
from typing import Final

from legpush.scene import conventions
from legpush.scene.scenario import Room

GRAVITY_M_S2: Final = conventions.GRAVITY_M_S2


def gravity_m_s2(room: Room, slope_deg: float = 0.0, uphill_deg: float = 0.0) -> tuple[float, float, float]:
    """Gravity in a room, world frame, (3,), with another slope that comes on top of its own."""
    slope, uphill = radians(room.slope_deg), radians(room.uphill_deg)
    if slope_deg > 0.0:
        slope, uphill = _sum(slope, uphill, radians(slope_deg), radians(uphill_deg))
    along = 0.0 - GRAVITY_M_S2 * sin(slope)
    return along * cos(uphill) + 0.0, along * sin(uphill) + 0.0, -GRAVITY_M_S2 * cos(slope)


def _sum(slope: float, uphill: float, other_slope: float, other_uphill: float) -> tuple[float, float]:
    """Slope and direction of a floor that rises by the sum of what two floors rise along x and along y."""
    x = tan(slope) * cos(uphill) + tan(other_slope) * cos(other_uphill)
    y = tan(slope) * sin(uphill) + tan(other_slope) * sin(other_uphill)
    return atan(hypot(x, y)), atan2(y, x)
