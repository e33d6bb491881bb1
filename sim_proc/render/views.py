"""The views from which a film can be seen."""

from dataclasses import dataclass
from math import pi, radians, tan
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.options.formats import View
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.render.film import Film

FIELD_OF_VIEW_RAD: Final = radians(45.0)
"""Angle from the lower to the upper border of a frame, MuJoCo's default."""
AHEAD_M: Final = 0.35
"""Distance ahead of the robot of the point that cameras look at."""
LOOK_HEIGHT_M: Final = 0.2
"""Height of that point."""
ORBIT_S: Final = 60.0
"""Simulated time of one turn around the robot."""
FROM_ABOVE: Final[tuple[View, ...]] = ("top", "room")
ROOM_BORDER: Final = 1.08
"""Ratio of the visible floor to the floor of the room."""


@dataclass(frozen=True, kw_only=True)
class Look:
    """Placement of a free camera of MuJoCo: the point it looks at, and from where."""

    at_m: Floats
    """The point that it looks at, world frame, (3,)."""
    distance_m: float
    azimuth_rad: float
    """Direction in which it looks, measured about z."""
    elevation_rad: float
    """Negative if it looks down."""


def look(film: Film, view: View, row: int, aspect: float) -> Look:
    """Where the camera of a view is at a row of the film; `aspect` is width over height of the frame."""
    heading = float(film.heading_rad[row])
    match view:
        case "follow":
            return _at_robot(film, row, heading + radians(65.0), -28.0)
        case "side":
            return _at_robot(film, row, heading + pi / 2, -15.0, distance_m=2.6)
        case "front":
            return _at_robot(film, row, heading + pi, -22.0)
        case "rear":
            return _at_robot(film, row, heading, -22.0)
        case "orbit":
            return _at_robot(film, row, float(film.heading_rad[0]) + 2 * pi * row * CONTROL_PERIOD_S / ORBIT_S, -28.0)
        case "top":
            return _at_robot(film, row, pi / 2, -90.0, distance_m=4.5)
        case "box":
            at = np.array([*film.box_m[row], film.scenario.box.size_m[2] / 2])
            azimuth = float(film.box_heading_rad[row]) + radians(50.0)
            return Look(at_m=at, distance_m=2.2, azimuth_rad=azimuth, elevation_rad=radians(-24.0))
        case "room":
            x, y = film.scenario.room.size_m
            distance = ROOM_BORDER * max(y, x / aspect) / (2 * tan(FIELD_OF_VIEW_RAD / 2))
            at = np.array([x / 2, y / 2, 0.0])
            return Look(at_m=at, distance_m=distance, azimuth_rad=pi / 2, elevation_rad=-pi / 2)


def _at_robot(film: Film, row: int, azimuth_rad: float, elevation_deg: float, distance_m: float = 3.3) -> Look:
    heading = film.heading_rad[row]
    ahead = AHEAD_M * np.array([np.cos(heading), np.sin(heading)])
    at = np.array([*(film.trunk_m[row] + ahead), LOOK_HEIGHT_M])
    return Look(at_m=at, distance_m=distance_m, azimuth_rad=azimuth_rad, elevation_rad=radians(elevation_deg))
