"""Plans the motion of the centre of mass and the forces of the feet: ZMP preview, force distribution.

The centre of mass is planned as a linear inverted pendulum of constant height. Linear least squares over the steps
ahead finds the sequence of jerks that keeps the zero-moment point near its reference (ZMP preview control). The
reference is that of Eq. 8: shifted toward the centroid of the supporting feet until it has the wanted margin.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import sqrt
from typing import Final, NamedTuple

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.gravity import GRAVITY_M_S2

JERK_WEIGHT: Final = 1e-6
END_WEIGHT: Final = 0.1
"""Weights of the jerk, and of the velocity at the end, against 1 for the deviation of the ZMP."""


@dataclass(frozen=True, kw_only=True)
class ComPlan:
    """A planned motion of the centre of mass and the ZMP over the ground, (n, 2) each, a row per tick, world frame."""

    position_m: Floats
    velocity_m_s: Floats
    acceleration_m_s2: Floats
    zmp_m: Floats

    def state(self, tick: int) -> Floats:
        """Position, velocity and acceleration at a tick, (3, 2)."""
        return np.stack([self.position_m[tick], self.velocity_m_s[tick], self.acceleration_m_s2[tick]])


def plan_com(
    state: Floats, zmp_reference_m: Floats, weights: tuple[float, ...], end_velocity_m_s: Floats, height_m: float
) -> ComPlan:
    """The least-squares motion from `state` (3, 2) for a ZMP reference (n, 2) with one weight per tick.

    `end_velocity_m_s` (2,) is the wanted velocity after the last tick, and `height_m` the height of the pendulum.
    """
    from_reference, from_state, from_end = _preview_gains(weights, height_m)
    position, velocity, acceleration = (
        a @ zmp_reference_m + b @ state + c[:, None] * end_velocity_m_s
        for a, b, c in zip(from_reference, from_state, from_end, strict=True)
    )
    zmp = position - height_m / GRAVITY_M_S2 * acceleration
    return ComPlan(position_m=position, velocity_m_s=velocity, acceleration_m_s2=acceleration, zmp_m=zmp)


@lru_cache(maxsize=256)
def _preview_gains(weights: tuple[float, ...], height_m: float) -> tuple[list[Floats], list[Floats], list[Floats]]:
    """Linear maps from ZMP reference, initial state and end velocity to position, velocity and acceleration.

    Minimizes `sum w (zmp - reference)^2 + JERK_WEIGHT |jerk|^2 + END_WEIGHT (end velocity error^2 + 0.01 end
    acceleration^2)` over piecewise constant jerks.
    """
    dt, n = CONTROL_PERIOD_S, len(weights)
    time = dt * np.arange(1, n + 1)
    zero, one = np.zeros(n), np.ones(n)
    free = [np.stack(rows, axis=1) for rows in ((one, time, time**2 / 2), (zero, one, time), (zero, zero, one))]
    lag = np.subtract.outer(np.arange(n), np.arange(n))
    past = lag >= 0
    forced = [
        np.where(past, dt**3 * (1 / 6 + lag / 2 + lag**2 / 2), 0.0),
        np.where(past, dt**2 * (0.5 + lag), 0.0),
        np.where(past, dt, 0.0),
    ]
    zmp_free = free[0] - height_m / GRAVITY_M_S2 * free[2]
    zmp_forced = forced[0] - height_m / GRAVITY_M_S2 * forced[2]
    weighted = zmp_forced.T * np.asarray(weights)
    ends = [(END_WEIGHT, forced[1][-1], free[1][-1]), (0.01 * END_WEIGHT, forced[2][-1], free[2][-1])]
    normal = weighted @ zmp_forced + JERK_WEIGHT * np.eye(n) + sum(w * np.outer(f, f) for w, f, _ in ends)
    by_state = -(weighted @ zmp_free + sum(w * np.outer(f, g) for w, f, g in ends))
    by_end = END_WEIGHT * forced[1][-1]
    jerk = np.linalg.solve(normal, np.column_stack([weighted, by_state, by_end]))
    by_reference, by_state, by_end = jerk[:, :n], jerk[:, n : n + 3], jerk[:, n + 3]
    return (
        [f @ by_reference for f in forced],
        [g + f @ by_state for f, g in zip(forced, free, strict=True)],
        [f @ by_end for f in forced],
    )


def triangle_margin(points_m: Floats, support_feet_m: Floats) -> Floats:
    """Signed distance of points (n, 2) to the border of one triangle of feet (3, 2), inside positive, (n,)."""
    x, y = points_m.T
    distances = [(x - edge.x_m) * edge.inward_x + (y - edge.y_m) * edge.inward_y for edge in _edges(support_feet_m)]
    margins: Floats = np.minimum.reduce(distances)
    return margins


def shifted_reference(nominal_m: Floats, support_feet_m: Floats, margin_m: float) -> Floats:
    """The first point (2,) with the margin on the way from `nominal_m` to the centroid of three feet (3, 2) (Eq. 8).

    That is the nominal point itself if it has the margin. If not even the centroid has it, the result is the centroid.
    """
    # Plain numbers, since NumPy is slow at a handful of them.
    (x, y), (centroid_x, centroid_y) = nominal_m.tolist(), support_feet_m.mean(axis=0).tolist()
    fraction = 0.0
    for edge in _edges(support_feet_m):
        at_nominal = edge.distance_m(x, y)
        if at_nominal < margin_m:
            at_centroid = edge.distance_m(centroid_x, centroid_y)
            if at_centroid < margin_m:
                return np.array([centroid_x, centroid_y])
            fraction = max(fraction, (margin_m - at_nominal) / (at_centroid - at_nominal))
    return np.array([x + fraction * (centroid_x - x), y + fraction * (centroid_y - y)])


class _Edge(NamedTuple):
    """An edge of a triangle: a point on it, and its normal, which has length 1 and points into the triangle."""

    x_m: float
    y_m: float
    inward_x: float
    inward_y: float

    def distance_m(self, x_m: float, y_m: float) -> float:
        """Signed distance of a point, inside positive."""
        return (x_m - self.x_m) * self.inward_x + (y_m - self.y_m) * self.inward_y


def _edges(support_feet_m: Floats) -> list[_Edge]:
    """The three edges of a triangle (3, 2)."""
    corners = support_feet_m.tolist()
    (x, y), (second_x, second_y), (third_x, third_y) = corners
    if (second_x - x) * (third_y - y) - (second_y - y) * (third_x - x) <= 0:
        corners.reverse()
    edges = []
    for (x, y), (next_x, next_y) in zip(corners, [*corners[1:], corners[0]], strict=True):
        along_x, along_y = next_x - x, next_y - y
        length_m = sqrt(along_x * along_x + along_y * along_y)
        edges.append(_Edge(x, y, -along_y / length_m, along_x / length_m))
    return edges


def foot_forces(
    feet_m: Floats, load_share: Floats, zmp_m: Floats, acceleration_m_s2: Floats, mass_kg: float | Floats
) -> Floats:
    """Ground reaction forces (n, 4, 3) of feet (n, 4, 3) that keep the ZMP (n, 2) and accelerate the robot (n, 2).

    On a slope the acceleration is relative to free fall along the floor.

    The vertical forces carry the weight and balance about the ZMP with the least norm, weighted by `load_share` (n, 4)
    (Eq. 9). The feet share the horizontal force in proportion to their vertical forces. The force that pushing a light
    box takes is small beside the weight, and is left to the servos. `mass_kg` is one number, or one for each tick,
    (n, 1).
    """
    n = len(zmp_m)
    balance = np.ones((n, 3, 4))
    balance[:, 1:] = (feet_m[:, :, :2] - zmp_m[:, None]).transpose(0, 2, 1)
    weighted = balance * load_share[:, None]
    wanted = np.zeros((n, 3, 1))
    wanted[:, 0] = mass_kg * GRAVITY_M_S2
    multipliers = np.linalg.solve(weighted @ balance.transpose(0, 2, 1), wanted)
    vertical = (weighted * multipliers).sum(axis=1)
    forces = np.empty((n, 4, 3))
    forces[:, :, :2] = (vertical / GRAVITY_M_S2)[:, :, None] * acceleration_m_s2[:, None]
    forces[:, :, 2] = vertical
    return forces
