"""How the trunk turns during a step."""

from functools import lru_cache

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import wrap_angle
from legpush.scene.conventions import CONTROL_PERIOD_S


def turn(start_rad: float, start_rate_rad_s: float, end_rad: float, n_ticks: int) -> tuple[Floats, Floats]:
    """A cubic from the present yaw and rate to `end_rad`, (n,), and its rates, (n,), the last of which is the mean."""
    duration = n_ticks * CONTROL_PERIOD_S
    change = wrap_angle(end_rad - start_rad)
    (start, middle, end), (start_rate, middle_rate, end_rate) = _hermite(n_ticks)
    rate = change / duration
    start_slope, end_slope = start_rate_rad_s * duration, rate * duration
    yaw = start_rad + start_slope * start + change * middle + end_slope * end
    yaw_rate = start_slope * start_rate + change * 6 * middle_rate + end_slope * end_rate
    return yaw, yaw_rate / duration


@lru_cache
def _hermite(n_ticks: int) -> tuple[list[Floats], list[Floats]]:
    """The cubic Hermite basis of start slope, change and end slope at the ends of ticks, (n,) each, and its slopes.

    That of the change is divided by 6.
    """
    u = np.arange(1, n_ticks + 1) / n_ticks
    square, cube = u**2, u**3
    return (
        [u - 2 * square + cube, 3 * square - 2 * cube, cube - square],
        [1 - 4 * u + 3 * square, u - square, 3 * square - 2 * u],
    )
