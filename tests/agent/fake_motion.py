"""Motions without physics: a path that is followed exactly, and ticks in which everything moves evenly."""

from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np

from legpush.geometry import Point3, Pose2
from legpush.messages.stepping import PathProgress, Trace, WorldState


class FollowedPath:
    """A path by its travelled length."""

    def __init__(self, waypoints: Sequence[Pose2]) -> None:
        self._poses = np.array([[p.x_m, p.y_m, p.yaw_rad] for p in waypoints])
        self._poses[:, 2] = np.unwrap(self._poses[:, 2])
        steps = np.hypot(*np.diff(self._poses[:, :2], axis=0).T)
        self._at_m = np.concatenate([[0.0], np.cumsum(steps)])
        self._travelled_m = 0.0

    def advance(self, by_m: float) -> Pose2:
        """Go on along the path, at most to its end."""
        self._travelled_m = min(self._travelled_m + by_m, float(self._at_m[-1]))
        x, y, yaw = (float(np.interp(self._travelled_m, self._at_m, column)) for column in self._poses.T)
        return Pose2(x_m=x, y_m=y, yaw_rad=yaw)

    def progress(self) -> PathProgress:
        """How far along."""
        length_m = float(self._at_m[-1])
        return PathProgress(travelled_m=self._travelled_m, length_m=length_m, done=self._travelled_m >= length_m - 1e-9)


def between(a: Pose2, b: Pose2, share: float) -> Pose2:
    """The pose at this share of the way from one to another, turning the shorter way."""
    turn = (b.yaw_rad - a.yaw_rad + pi) % (2 * pi) - pi
    return Pose2(
        x_m=a.x_m + share * (b.x_m - a.x_m), y_m=a.y_m + share * (b.y_m - a.y_m), yaw_rad=a.yaw_rad + share * turn
    )


def trace_of(begin_tick: int, states: Sequence[WorldState]) -> Trace:
    """The ticks after `begin_tick`, with these states and a trunk that sways a little."""
    n_ticks = len(states)
    return Trace(
        tick=tuple(range(begin_tick + 1, begin_tick + n_ticks + 1)),
        qpos=tuple(
            (
                *state.trunk.position_m,
                *state.trunk.orientation_wxyz,
                *state.joint_positions_rad,
                *state.box.position_m,
                *state.box.orientation_wxyz,
            )
            for state in states
        ),
        roll_pitch_rad=tuple((0.01 * sin(k / 8), 0.02 * cos(k / 8)) for k in range(n_ticks)),
        tips_m=tuple(state.tips_m for state in states),
        contact_forces_n=tuple(_upward(*state.foot_forces_n) for state in states),
        com_m=tuple(state.trunk.position_m for state in states),
        zmp_m=tuple((state.trunk.position_m[0], state.trunk.position_m[1]) for state in states),
        support_margin_m=tuple(0.06 + 0.03 * sin(k / 6) for k in range(n_ticks)),
    )


def _upward(fl: float, fr: float, rl: float, rr: float) -> tuple[Point3, Point3, Point3, Point3]:
    """Forces of the feet as vectors."""
    return (0.0, 0.0, fl), (0.0, 0.0, fr), (0.0, 0.0, rl), (0.0, 0.0, rr)
