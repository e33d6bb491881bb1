"""Footsteps along a path.

Each pose on the path places the foot rectangle, and the displacements of its corners are the steps of the legs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.paths import travelled_m
from legpush.scene.robot import LEGS, Leg, foot_rectangle_b

GAIT_ORDER: Final[tuple[Leg, ...]] = ("RR", "FR", "RL", "FL")
"""Lateral sequence of the crawl: the weight changes sides twice a cycle."""
STRIDE_M: Final = 0.4
MAX_STEP_M: Final = 0.48
MAX_TURN_RAD: Final = 0.6
"""Limits of one gait cycle: advance of the trunk, displacement of a foot, change of heading."""
STRIDE_BY_DIRECTION: Final = (
    (0.0, STRIDE_M),
    (45.0, STRIDE_M),
    (60.0, 0.2),
    (80.0, 0.15),
    (130.0, 0.15),
    (150.0, 0.2),
    (165.0, 0.25),
    (175.0, 0.3),
    (177.0, STRIDE_M),
    (180.0, STRIDE_M),
)
"""Longest advance of the trunk in one gait cycle, by the angle [deg] between its motion and its heading.

At longer ones the centre of mass leaves the support, and sideways the robot falls (`python -m benchmarks.sideways`).
"""
SAME_M: Final = 1e-6
ADVANCES: Final = np.linspace(1.0, 0.05, 20)
"""Shares of the stride to try, the longest first."""


class PosePath:
    """A path of planar poses, parametrized by travelled length. A turn counts by the arc that the feet describe."""

    def __init__(self, waypoints: Sequence[Pose2]) -> None:
        """Join the waypoints by straight lines and by uniform turns the short way round."""
        xy = np.array([[p.x_m, p.y_m] for p in waypoints])
        yaw = np.unwrap([p.yaw_rad for p in waypoints])
        self._travelled = travelled_m(waypoints)
        self._xy_yaw = np.column_stack([xy, yaw])
        self.length_m = float(self._travelled[-1])

    def poses(self, travelled_m: Floats) -> Floats:
        """x, y and unwrapped yaw at travelled lengths (...,), clamped to the path, (..., 3)."""
        return np.stack([np.interp(travelled_m, self._travelled, column) for column in self._xy_yaw.T], axis=-1)

    def corners(self, travelled_m: Floats) -> Floats:
        """Corner of the foot rectangle of each leg at its own travelled length, (..., 4) to (..., 4, 2)."""
        pose = self.poses(travelled_m)
        c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
        corner = foot_rectangle_b()
        x = pose[..., 0] + c * corner[:, 0] - s * corner[:, 1]
        y = pose[..., 1] + s * corner[:, 0] + c * corner[:, 1]
        return np.stack([x, y], axis=-1)


@dataclass(frozen=True, kw_only=True)
class CycleTargets:
    """Targets of the feet in one gait cycle."""

    travelled_m: Floats
    """Travelled length of each leg's rectangle in the order of `LEGS`, (4,). The trunk is at their mean."""
    feet_m: Floats
    """Where the feet come down, (4, 2)."""


def next_cycle(path: PosePath, travelled_m: Floats, feet_m: Floats) -> CycleTargets:
    """The longest gait cycle within the limits, from feet `feet_m` (4, 2) whose rectangles are at `travelled_m` (4,).

    A leg that swings at phase phi of the cycle lands where the trunk will be half a cycle later, so every foot is under
    its own hip at mid-stance. At the end of the path all feet come together in the last rectangle.
    """
    phase = np.empty(4)
    for place, leg in enumerate(GAIT_ORDER):
        phase[LEGS.index(leg)] = (place + 0.5) / len(GAIT_ORDER)
    start = float(travelled_m.mean())
    advance = STRIDE_M * ADVANCES[:, None]
    candidates = np.clip(start + advance * (phase + 0.5), travelled_m, path.length_m)
    corners = path.corners(candidates)
    step = np.linalg.norm(corners - feet_m, axis=-1).max(axis=1)
    moved = path.poses(candidates.mean(axis=1)) - path.poses(np.array(start))
    is_short = np.hypot(moved[:, 0], moved[:, 1]) <= longest_stride_m(moved, path.poses(np.array(start))[2]) + SAME_M
    allowed = np.flatnonzero((step <= MAX_STEP_M) & (np.abs(moved[:, 2]) <= MAX_TURN_RAD) & is_short)
    best = int(allowed[0]) if allowed.size else len(candidates) - 1
    return CycleTargets(travelled_m=candidates[best], feet_m=corners[best])


def longest_stride_m(moved: Floats, yaw_rad: float) -> Floats:
    """Longest advance by `STRIDE_BY_DIRECTION` for displacements (x, y, turn), (n, 3), from a heading; (n,).

    The direction counts from the heading half way.
    """
    away = np.arctan2(moved[:, 1], moved[:, 0]) - yaw_rad - moved[:, 2] / 2
    directions_deg, strides_m = zip(*STRIDE_BY_DIRECTION, strict=True)
    angle_deg = np.degrees(np.abs(np.arctan2(np.sin(away), np.cos(away))))
    longest: Floats = np.interp(angle_deg, directions_deg, strides_m)
    return longest
