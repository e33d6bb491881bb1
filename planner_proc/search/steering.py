"""Joins two states of a search: by a straight line, or by the shortest curve with a minimum turning radius."""

from abc import ABC, abstractmethod
from itertools import pairwise
from math import ceil, pi
from typing import Any, Final

import numpy as np
from ompl import base as ob

from legpush.arrays import Floats
from legpush.geometry import Point2, Pose2, wrap_angle
from legpush.messages.planning import TrunkPathQuery
from planner_proc.clearance.field import ClearanceField

SPACING_M: Final = 0.05
"""Greatest distance between the poses of a curve that is returned."""
_CHECKED_M: Final = 0.1
"""Greatest distance between the poses of a curve that is checked."""
_WHOLE_STEP: Final = 0.99
"""If the ends of a step are nearer to each other than this share of its length, the curve turns back between them."""
_CUSP_SAMPLES: Final = 21
"""How many poses of a step to compare in each round of the search for a cusp."""
_CUSP_ROUNDS: Final = 3
"""How many rounds to search for a cusp, each between the neighbours of the best pose so far."""


class Steer(ABC):
    """A space of states, and which ways between them keep the clearance."""

    space: Any

    def __init__(self, query: TrunkPathQuery, field: ClearanceField) -> None:
        """Take the `field` of the query's grid."""
        self._query = query
        self._field = field

    @abstractmethod
    def state(self, pose: Pose2) -> Any:
        """Make a new state at a pose."""

    @abstractmethod
    def place(self, state: Any) -> Point2:
        """Position of a state."""

    @abstractmethod
    def is_free(self, a: Any, b: Any) -> bool:
        """Whether the way from one state to another keeps the clearance at every point."""

    @abstractmethod
    def curve(self, states: list[Any]) -> Floats | None:
        """The way through some states, shortened, as dense poses, (n, 3); None if it is straight between the states."""

    def _bounds(self) -> Any:
        """Bounds of the plane: those of the grid."""
        bounds = ob.RealVectorBounds(2)
        for axis, (low_m, size_m) in enumerate(zip(self._query.grid.origin_m, self._field.size_m, strict=True)):
            bounds.setLow(axis, low_m)
            bounds.setHigh(axis, low_m + size_m)
        return bounds


class Straight(Steer):
    """Points of the plane, joined by straight lines; the robot turns on the spot."""

    def __init__(self, query: TrunkPathQuery, field: ClearanceField) -> None:
        super().__init__(query, field)
        self.space = ob.RealVectorStateSpace(2)
        self.space.setBounds(self._bounds())
        self._segment_is_free = field.segment_is_free
        self._clearance_m = query.clearance_m

    def state(self, pose: Pose2) -> Any:
        state = self.space.allocState()
        state[0], state[1] = pose.x_m, pose.y_m
        return state

    def place(self, state: Any) -> Point2:
        return state[0], state[1]

    def is_free(self, a: Any, b: Any) -> bool:
        return self._segment_is_free((a[0], a[1]), (b[0], b[1]), self._clearance_m)

    def curve(self, states: list[Any]) -> Floats | None:
        return None


class Curved(Steer):
    """Poses, joined by the curves of Dubins or of Reeds and Shepp."""

    def __init__(self, query: TrunkPathQuery, field: ClearanceField) -> None:
        super().__init__(query, field)
        kind = ob.DubinsStateSpace if query.steering == "dubins" else ob.ReedsSheppStateSpace
        self.space = kind(query.min_turning_radius_m)
        self.space.setBounds(self._bounds())
        self._at = self.space.allocState()
        self._sagitta_m = min(_CHECKED_M**2 / (8.0 * query.min_turning_radius_m), _CHECKED_M / 2.0)
        """Greatest distance between an arc and its chord. The clearance is checked along other chords than those of the
        curve that is returned.
        """

    def state(self, pose: Pose2) -> Any:
        state = self.space.allocState()
        state.setXY(pose.x_m, pose.y_m)
        yaw_rad = wrap_angle(pose.yaw_rad)
        # OMPL's headings are below pi.
        state.setYaw(-pi if yaw_rad == pi else yaw_rad)
        return state

    def place(self, state: Any) -> Point2:
        return state.getX(), state.getY()

    def is_free(self, a: Any, b: Any) -> bool:
        points_m = self._poses(a, b, _CHECKED_M)[:, :2]
        return bool(self._field.free_segments(points_m, self._query.clearance_m + self._sagitta_m).all())

    def curve(self, states: list[Any]) -> Floats | None:
        kept = self._shortened(self._with_middles(states))
        parts = [self._poses(a, b, SPACING_M) for a, b in pairwise(kept)]
        return np.concatenate([parts[0][:1], *(part[1:] for part in parts)]) if parts else None

    def _with_middles(self, states: list[Any]) -> list[Any]:
        """The states, with those half-way between them."""
        found = states[:1]
        for a, b in pairwise(states):
            middle = self.space.allocState()
            self.space.interpolate(a, b, 0.5, middle)
            found += [middle, b]
        return found

    def _shortened(self, states: list[Any]) -> list[Any]:
        """Go from each state directly to the last one that can be reached freely, and by a shorter way than before."""
        lengths_m = [self.space.distance(a, b) for a, b in pairwise(states)]
        travelled_m = np.concatenate([[0.0], np.cumsum(lengths_m)])
        kept, last = [0], len(states) - 1
        while (here := kept[-1]) < last:
            nearer = (
                there
                for there in range(last, here + 1, -1)
                if self.space.distance(states[here], states[there]) < travelled_m[there] - travelled_m[here]
                and self.is_free(states[here], states[there])
            )
            kept.append(next(nearer, here + 1))
        return [states[k] for k in kept]

    def _poses(self, a: Any, b: Any, spacing_m: float) -> Floats:
        """Poses along the way between two states, both included, at most `spacing_m` apart, (n, 3).

        The poses at which the direction of motion changes (the cusps) are added.
        """
        length_m = self.space.distance(a, b)
        n = max(1, ceil(length_m / spacing_m))
        poses = self._at_shares(a, b, np.linspace(0.0, 1.0, n + 1))
        if self._query.steering == "dubins":
            return poses
        steps_m = np.hypot(*np.diff(poses[:, :2], axis=0).T)
        turning = np.flatnonzero(steps_m < _WHOLE_STEP * length_m / n)
        cusps = [self._cusp(a, b, k / n, (k + 1) / n) for k in turning.tolist()]
        return np.insert(poses, turning + 1, cusps, axis=0) if cusps else poses

    def _cusp(self, a: Any, b: Any, low: float, high: float) -> Floats:
        """The pose, (3,), at which the way turns back between two of its shares.

        It has the largest sum of distances to both. The distance to the first alone would be largest at the second, if
        the way back is the longer one.
        """
        begin_m, end_m = self._at_shares(a, b, np.array([low, high]))[:, :2]
        for _ in range(_CUSP_ROUNDS):
            shares = np.linspace(low, high, _CUSP_SAMPLES)
            poses = self._at_shares(a, b, shares)
            apart_m = np.hypot(*(poses[:, :2] - begin_m).T) + np.hypot(*(poses[:, :2] - end_m).T)
            best = int(apart_m.argmax())
            low, high = shares[max(best - 1, 0)], shares[min(best + 1, _CUSP_SAMPLES - 1)]
        cusp: Floats = poses[best]
        return cusp

    def _at_shares(self, a: Any, b: Any, shares: Floats) -> Floats:
        """Poses at shares of the way from one state to another, (n, 3)."""
        poses = np.empty((len(shares), 3))
        for k, share in enumerate(shares.tolist()):
            self.space.interpolate(a, b, share, self._at)
            poses[k] = self._at.getX(), self._at.getY(), self._at.getYaw()
        return poses
