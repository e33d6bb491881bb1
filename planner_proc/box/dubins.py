"""Shortest forward paths with a minimum turning radius (Dubins), computed by OMPL."""

from math import ceil
from typing import Any, Final

import numpy as np
from ompl import base as ob

from legpush.arrays import Floats
from legpush.geometry import Pose2

SAMPLE_M: Final = 0.025
"""Greatest distance between two poses of a path."""
_FAR_M: Final = 1e7
"""Bound of the state space, which OMPL asks for; farther than any map."""


class Dubins:
    """Paths of a frame that moves along its x axis and turns no tighter than a radius."""

    def __init__(self, min_turning_radius_m: float) -> None:
        self._space = ob.DubinsStateSpace(min_turning_radius_m)
        bounds = ob.RealVectorBounds(2)
        bounds.setLow(-_FAR_M)
        bounds.setHigh(_FAR_M)
        self._space.setBounds(bounds)
        self._a, self._b, self._at = (self._space.allocState() for _ in range(3))

    def length_m(self, a: Pose2, b: Pose2) -> float:
        """Length of the path from one pose to another."""
        self._set(a, b)
        return float(self._space.distance(self._a, self._b))

    def poses(self, a: Pose2, b: Pose2) -> Floats:
        """Poses along the path from one pose to another, both included, at most `SAMPLE_M` apart, (n, 3)."""
        length_m = self.length_m(a, b)
        n = max(1, ceil(length_m / SAMPLE_M))
        poses = np.empty((n + 1, 3))
        for k in range(n + 1):
            self._space.interpolate(self._a, self._b, k / n, self._at)
            poses[k] = self._at.getX(), self._at.getY(), self._at.getYaw()
        return poses

    def along(self, a: Pose2, b: Pose2, distance_m: float) -> Pose2:
        """Pose at a distance along the path from one pose to another."""
        length_m = self.length_m(a, b)
        if distance_m >= length_m:
            return b
        self._space.interpolate(self._a, self._b, distance_m / length_m, self._at)
        return Pose2(x_m=self._at.getX(), y_m=self._at.getY(), yaw_rad=self._at.getYaw())

    def _set(self, a: Pose2, b: Pose2) -> None:
        for state, pose in ((self._a, a), (self._b, b)):
            _set_state(state, pose)


def _set_state(state: Any, pose: Pose2) -> None:
    state.setX(pose.x_m)
    state.setY(pose.y_m)
    state.setYaw(pose.yaw_rad)
