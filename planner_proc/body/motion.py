"""Sequences of poses of the trunk (x, y, yaw), (n, 3): what they cost, and the poses in between."""

from itertools import pairwise
from math import ceil, pi
from typing import Final

import numpy as np

from legpush.arrays import Floats

SAMPLE_M: Final = 0.02
"""Greatest distance between two poses that are checked."""
SAMPLE_RAD: Final = 0.025
"""Greatest turn between them."""
_ANGLES_RAD: Final = np.radians([0.0, 40.0, 60.0, 80.0, 130.0, 150.0, 170.0, 180.0])
_EFFORTS: Final = np.array([1.0, 1.0, 2.0, 2.7, 2.7, 2.0, 1.3, 1.3])
"""How much a metre costs by the angle between motion and heading: a legged robot is slower sideways and backward."""


def effort(angles_rad: Floats) -> Floats:
    """Cost per metre of motion at angles from the heading, (...), (...)."""
    wrapped = np.abs((angles_rad + pi) % (2 * pi) - pi)
    factor: Floats = np.interp(wrapped, _ANGLES_RAD, _EFFORTS)
    return factor


def turn_rad(begin_rad: float, end_rad: float) -> float:
    """The short turn from one heading to another."""
    return (end_rad - begin_rad + pi) % (2 * pi) - pi


def cost_m(poses: Floats, turn_m: float) -> float:
    """Cost of a motion; a turn by 1 rad costs as much as `turn_m` straight ahead."""
    steps = np.diff(poses, axis=0)
    turns = (steps[:, 2] + pi) % (2 * pi) - pi
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    away = np.arctan2(steps[:, 1], steps[:, 0]) - poses[:-1, 2] - turns / 2
    return float((lengths * effort(away)).sum() + turn_m * np.abs(turns).sum())


def filled(poses: Floats, step_m: float = SAMPLE_M, step_rad: float = SAMPLE_RAD) -> Floats:
    """The poses with more in between, by straight lines and uniform turns the short way round, (k, 3)."""
    parts = [poses[:1]]
    for begin, end in pairwise(poses):
        move = end - begin
        move[2] = turn_rad(begin[2], end[2])
        n = max(1, ceil(np.hypot(move[0], move[1]) / step_m), ceil(abs(move[2]) / step_rad))
        parts.append(begin + np.linspace(0.0, 1.0, n + 1)[1:, None] * move)
    return np.concatenate(parts)
