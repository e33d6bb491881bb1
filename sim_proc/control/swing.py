"""Curves of a foot in the air: the step and its landing and the Bezier push (Eqs. 14, 15)."""

from collections.abc import Sequence
from functools import lru_cache
from math import comb, pi
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from legpush.arrays import Flags, Floats, Integers
from legpush.bounds import MAX_TICKS
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.robot_motion import Gait

Locus = Literal["swing", "published"]

LOCUS_RANGE_RAD: Final[dict[Locus, tuple[float, float]]] = {"swing": (-pi / 2, pi / 2), "published": (0.0, pi)}
"""theta_min and theta_max of Eq. 15: the half circle on the swing side of the chord, and the one in the paper."""

APEX_SHARE: Final = 0.45
"""When a foot is highest: share of the flight before the landing."""
SETTLED_SHARE: Final = 0.75
"""Share of the landing in which the foot only moves down."""


def minimum_jerk(n_ticks: int) -> Floats:
    """Progress from 0 to 1 at the end of each of `n_ticks` ticks, (n,), at rest at both ends."""
    return quintic(np.arange(1, n_ticks + 1) / n_ticks)


def quintic(u: Floats) -> Floats:
    """Minimum-jerk progress from 0 to 1 at shares of its time, (n,)."""
    progress: Floats = u**3 * (10 - 15 * u + 6 * u**2)
    return progress


def gentle_stop(n_ticks: int) -> Floats:
    """Progress from 0 to 1 at the end of each of `n_ticks` ticks, (n,), that slows down over two thirds of the time.

    Its greatest deceleration is 4 / T^2, against 5.8 / T^2 for minimum jerk. A box that friction can slow down as fast
    stays at the foot and is not thrown.
    """
    u = np.arange(1, n_ticks + 1) / n_ticks
    progress: Floats = u**2 * (6 - 8 * u + 3 * u**2)
    return progress


def flight_ticks(n_ticks: int, gait: Gait) -> int:
    """Ticks of a step before its landing, in which the foot may move fast."""
    return n_ticks - min(gait.landing_ticks, n_ticks - 2)


def search_swing(start_m: Floats, gait: Gait) -> Floats:
    """A foot that goes straight down from `start_m`, (3,), and looks for the floor; one point per tick, (n, 3).

    It begins at the landing speed, and becomes faster tick by tick up to the speed of the search.
    """
    tick_m = CONTROL_PERIOD_S * np.minimum(
        gait.landing_speed_m_s * np.arange(1, MAX_TICKS + 1), max(gait.search_speed_m_s, gait.landing_speed_m_s)
    )
    depths_m = np.minimum(np.cumsum(tick_m), gait.search_depth_m)
    n_ticks = int(np.searchsorted(depths_m, gait.search_depth_m)) + 1
    curve = np.repeat(start_m[None], min(n_ticks, MAX_TICKS), axis=0)
    curve[:, 2] -= depths_m[:n_ticks]
    return curve


def landing_swing(start_m: ArrayLike, end_m: ArrayLike, height_m: float, n_ticks: int, gait: Gait) -> Floats:
    """A step from `start_m` to `end_m`, (3,) each, that touches down slowly; one point per tick, (n, 3).

    The foot rises by `height_m` above the higher end. It comes down to the landing speed, with which it moves on for
    the landing ticks. Along the floor it is at its place a little earlier.
    """
    start, end = np.asarray(start_m, dtype=np.float64), np.asarray(end_m, dtype=np.float64)
    flight, speed = flight_ticks(n_ticks, gait), gait.landing_speed_m_s * CONTROL_PERIOD_S
    shares = _landing_shares(n_ticks, flight)
    landing, falls = n_ticks - flight, flight - APEX_SHARE * flight
    apex_m = max(start[2] + height_m, end[2] + height_m, end[2] + speed * landing)
    curve: Floats = start + shares.along[:, None] * (end - start)
    rising = start[2] + (apex_m - start[2]) * shares.risen
    drop, slope = end[2] + speed * landing - apex_m, -speed * falls
    u3, u4, u5 = shares.fallen_powers
    falling = apex_m + (10 * drop - 4 * slope) * u3 + (7 * slope - 15 * drop) * u4 + (6 * drop - 3 * slope) * u5
    lands = end[2] + speed * shares.ticks_left
    curve[:, 2] = np.where(shares.rises, rising, np.where(shares.flies, falling, lands))
    return curve


class _LandingShares(NamedTuple):
    """How far a step that lands has come at the end of each of its n ticks, (n,) each."""

    along: Floats
    """Share of the way along the floor."""
    risen: Floats
    """Share of the way up."""
    fallen_powers: tuple[Floats, Floats, Floats]
    """Share of the time from the highest point to the landing, to the powers of 3, 4 and 5."""
    ticks_left: Integers
    rises: Flags
    flies: Flags
    """Whether the foot still rises, and whether it does not land yet."""


@lru_cache
def _landing_shares(n_ticks: int, flight: int) -> _LandingShares:
    """The shares of a step of `n_ticks`, which begins to land after `flight` of them."""
    tick, apex = np.arange(1, n_ticks + 1), APEX_SHARE * flight
    u = np.clip((tick - apex) / (flight - apex), 0.0, 1.0)
    return _LandingShares(
        along=quintic(np.minimum(tick / (n_ticks - SETTLED_SHARE * (n_ticks - flight)), 1.0)),
        risen=quintic(np.minimum(tick / apex, 1.0)),
        fallen_powers=(u**3, u**4, u**5),
        ticks_left=n_ticks - tick,
        rises=tick <= apex,
        flies=tick <= flight,
    )


def control_points(
    start_m: ArrayLike, end_m: ArrayLike, weights: Sequence[float], locus: Locus, floor_m: float
) -> Floats:
    """The control points, (n + 1, 3), of a push of degree n from `start_m` to `end_m`, (3,) each (Eq. 15).

    The n - 1 inner ones, one for each of the `weights`, lie on the circle about the middle M of the chord, in the
    vertical plane through it: `P_i = M + r (sin(theta_i) u + cos(theta_i) n)`,
    `theta_i = theta_min + w_i (theta_max - theta_min)`, `u` along the chord and `n` upward. A point below `floor_m` is
    raised to it.
    """
    start, end = np.asarray(start_m, dtype=np.float64), np.asarray(end_m, dtype=np.float64)
    chord = end - start
    length = float(np.linalg.norm(chord))
    u = chord / length
    upward = np.array([0.0, 0.0, 1.0]) - u[2] * u
    n = upward / np.linalg.norm(upward)
    theta_min, theta_max = LOCUS_RANGE_RAD[locus]
    points = np.stack([start, *[start] * len(weights), end])
    for index, w in enumerate(weights, start=1):
        theta = theta_min + w * (theta_max - theta_min)
        points[index] = (start + end) / 2 + length / 2 * (np.sin(theta) * u + np.cos(theta) * n)
        points[index, 2] = max(points[index, 2], floor_m)
    return points


def bezier(points_m: ArrayLike, t: ArrayLike) -> Floats:
    """The Bezier curve of degree n (Eq. 14) of control points (n + 1, d) at parameters (m,), (m, d)."""
    points, t = np.asarray(points_m, dtype=np.float64), np.asarray(t, dtype=np.float64)
    degree = len(points) - 1
    basis = np.stack([comb(degree, i) * (1 - t) ** (degree - i) * t**i for i in range(degree + 1)], axis=-1)
    curve: Floats = basis @ points
    return curve
