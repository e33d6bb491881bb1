"""Footsteps along a path.

Each pose on the path places the foot rectangle, and the displacements of its corners are the steps of the legs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.geometry import Pose2
from legpush.scene.conventions import LEGS, Leg
from legpush.scene.paths import travelled_m
from legpush.scene.robot import RobotSpec
from legpush.scene.robot_motion import Gait

GAIT_ORDER: Final[tuple[Leg, ...]] = ("RR", "FR", "RL", "FL")
"""Lateral sequence of the crawl: the weight changes sides twice a cycle."""
STRIDE_SHARES: Final = (
    (0.0, 1.0),
    (40.0, 1.0),
    (45.0, 0.8),
    (60.0, 0.5),
    (80.0, 0.375),
    (130.0, 0.375),
    (150.0, 0.5),
    (165.0, 0.625),
    (175.0, 0.75),
    (177.0, 1.0),
    (180.0, 1.0),
)
"""Longest advance of the trunk in one gait cycle, as a share of the stride, by the angle [deg] between its motion and
its heading.

At longer ones the centre of mass leaves the support, and sideways the robot falls (`python -m benchmarks.sideways`).
"""
APART_SHARE: Final = 0.3
"""A foot steps no nearer to the one beside it than this share of the distance that they have under the robot.

Footsteps of a turn as quick as allowed keep 0.38 of it. Where a path turns back at once, those of the longest cycle
would cross.
"""
LEFT: Final = [LEGS.index("FL"), LEGS.index("RL")]
RIGHT: Final = [LEGS.index("FR"), LEGS.index("RR")]
SAME_M: Final = 1e-6
ADVANCES: Final = np.linspace(1.0, 0.05, 20)
"""Shares of the stride to try, the longest first."""


class PosePath:
    """A path of planar poses, parametrized by travelled length. A turn counts by the arc that the feet describe."""

    def __init__(self, robot: RobotSpec, waypoints: Sequence[Pose2]) -> None:
        """Join the waypoints by straight lines and by uniform turns the short way round."""
        self.gait = robot.gait
        """How the robot walks along it."""
        self._corners_b = robot.stance.foot_rectangle_b()
        self._width_m = robot.stance.foot_rectangle_width_m
        xy = np.array([[p.x_m, p.y_m] for p in waypoints])
        yaw = np.unwrap([p.yaw_rad for p in waypoints])
        self._travelled = travelled_m(waypoints, robot.stance.foot_circle_m)
        self._xy_yaw = np.column_stack([xy, yaw])
        self.length_m = float(self._travelled[-1])

    def poses(self, travelled_m: Floats) -> Floats:
        """x, y and unwrapped yaw at travelled lengths (...,), clamped to the path, (..., 3)."""
        return np.stack([np.interp(travelled_m, self._travelled, column) for column in self._xy_yaw.T], axis=-1)

    def ahead_of(self, travelled_m: float) -> tuple[Pose2, ...]:
        """Waypoints of the part of the path from a travelled length on."""
        later = self._xy_yaw[self._travelled > travelled_m]
        rows = np.concatenate([self.poses(np.array(travelled_m))[None], later]).tolist()
        return tuple(Pose2(x_m=x, y_m=y, yaw_rad=yaw) for x, y, yaw in rows)

    def corners(self, travelled_m: Floats) -> Floats:
        """Corner of the foot rectangle of each leg at its own travelled length, (..., 4) to (..., 4, 2)."""
        pose = self.poses(travelled_m)
        c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
        corner = self._corners_b
        x = pose[..., 0] + c * corner[:, 0] - s * corner[:, 1]
        y = pose[..., 1] + s * corner[:, 0] + c * corner[:, 1]
        return np.stack([x, y], axis=-1)

    def are_apart(self, feet_m: Floats, targets_m: Floats) -> Flags:
        """Whether feet at `feet_m` (4, 2) keep apart while they step to each of `targets_m` (n, 4, 2); (n,)."""
        return narrowest_m(feet_m, targets_m) >= APART_SHARE * self._width_m


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

    Where the shortest cycle is not within the limits either, it is taken.
    """
    gait = path.gait
    phase = np.empty(4)
    for place, leg in enumerate(GAIT_ORDER):
        phase[LEGS.index(leg)] = (place + 0.5) / len(GAIT_ORDER)
    start = float(travelled_m.mean())
    advance = gait.stride_m * ADVANCES[:, None]
    candidates = np.clip(start + advance * (phase + 0.5), travelled_m, path.length_m)
    corners = path.corners(candidates)
    step = np.linalg.norm(corners - feet_m, axis=-1).max(axis=1)
    moved = path.poses(candidates.mean(axis=1)) - path.poses(np.array(start))
    is_short = (
        np.hypot(moved[:, 0], moved[:, 1]) <= longest_stride_m(gait, moved, path.poses(np.array(start))[2]) + SAME_M
    )
    within = (step <= gait.max_step_m) & (np.abs(moved[:, 2]) <= gait.max_turn_rad) & is_short
    allowed = np.flatnonzero(within & path.are_apart(feet_m, corners))
    best = int(allowed[0]) if allowed.size else len(candidates) - 1
    return CycleTargets(travelled_m=candidates[best], feet_m=corners[best])


def narrowest_m(feet_m: Floats, targets_m: Floats) -> Floats:
    """Least distance between left and right foot, across the robot, while the feet step one after another; (n,).

    They stand at `feet_m` (4, 2) and step to `targets_m` (n, 4, 2) in the order of the gait. Below 0 they have crossed.
    """
    feet = np.broadcast_to(feet_m, targets_m.shape).copy()
    widths = []
    for leg in GAIT_ORDER:
        feet[:, LEGS.index(leg)] = targets_m[:, LEGS.index(leg)]
        along = feet[:, :2].sum(axis=1) - feet[:, 2:].sum(axis=1)
        along /= np.linalg.norm(along, axis=-1, keepdims=True)
        across = feet[:, LEFT] - feet[:, RIGHT]
        widths.append((along[:, None, 0] * across[..., 1] - along[:, None, 1] * across[..., 0]).min(axis=1))
    narrowest: Floats = np.min(widths, axis=0)
    return narrowest


def longest_stride_m(gait: Gait, moved: Floats, yaw_rad: float) -> Floats:
    """Longest advance by `STRIDE_SHARES` for displacements (x, y, turn), (n, 3), from a heading; (n,).

    The direction counts from the heading half way.
    """
    away = np.arctan2(moved[:, 1], moved[:, 0]) - yaw_rad - moved[:, 2] / 2
    directions_deg, shares = zip(*STRIDE_SHARES, strict=True)
    angle_deg = np.degrees(np.abs(np.arctan2(np.sin(away), np.cos(away))))
    longest: Floats = gait.stride_m * np.interp(angle_deg, directions_deg, shares)
    return longest
