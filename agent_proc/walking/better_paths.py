"""Better paths while the robot walks: joins a new one between gait cycles if that saves enough."""

from math import ceil, inf
from operator import itemgetter
from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.geometry import Pose2, distance_m
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.plans.trunk_queries import SLACK_M
from legpush.scene.clearance import Occupied
from legpush.scene.paths import arc_lengths_m, path_length_m, poses_along

LEAST_GAIN_M: Final = 0.1
"""Least length, turns included, that a better path has to save."""
JOIN_EVERY_M: Final = 0.25
JOIN_WITHIN_M: Final = 3.0
"""Places of the new path that the robot may go straight to: one every `JOIN_EVERY_M`, from the nearest place on, as far
as `JOIN_WITHIN_M` ahead of it."""
SPACING_M: Final = 0.05


class BetterPaths:
    """The revisions of a plan that the robot walks along, one for each gait cycle."""

    def __init__(self, query: TrunkPathQuery, plan: Plan, foot_circle_m: float) -> None:
        """`foot_circle_m` is the radius of the circle through the feet, with which the robot turns anywhere."""
        self.query = query
        self._foot_circle_m = foot_circle_m
        self._occupied = Occupied(query.grid)
        self._best_m = plan.length_m
        self._revision = 0

    def next_revision(self) -> int | None:
        """Number of the next revision; None after the last one."""
        anytime = self.query.anytime
        if anytime is None or self._revision >= anytime.n_improvements:
            return None
        self._revision += 1
        return self._revision

    def joined(self, plan: Plan, here: Pose2, left_m: float) -> tuple[Pose2, ...]:
        """The path from here to a plan and on along it, or nothing if the present one is about as short.

        `left_m` is the length that is left of the present path, turns included.
        """
        if plan.status != "exact" or plan.length_m >= self._best_m:
            return ()
        self._best_m = plan.length_m
        present_m = self._occupied.nearest(here.xy()[np.newaxis]).distance_m - SLACK_M
        required_m = max(min(self.query.clearance_m, present_m), self._foot_circle_m)
        ways = (self._way(plan.waypoints, k, here, required_m) for k in _places(plan.waypoints, here))
        measured = [(path_length_m(way, self._foot_circle_m), way) for way in ways if way]
        length_m, way = min(measured, key=itemgetter(0), default=(inf, ()))
        return way if length_m < left_m - LEAST_GAIN_M else ()

    def _way(self, waypoints: tuple[Pose2, ...], k: int, here: Pose2, required_m: float) -> tuple[Pose2, ...]:
        """From here straight to the k-th waypoint and on, or nothing if the straight line is not free."""
        there = waypoints[k]
        line = np.array([here.xy(), there.xy()])
        if self._occupied.nearest(line).distance_m < required_m:
            return ()
        length_m = distance_m(here, there)
        if length_m == 0.0:
            return (here, *waypoints[k:])
        heading_rad = float(np.arctan2(*(line[1] - line[0])[::-1]))
        n = max(1, ceil(length_m / SPACING_M))
        points = np.linspace(line[0], line[1], n + 1).tolist()
        straight = tuple(Pose2(x_m=x_m, y_m=y_m, yaw_rad=heading_rad) for x_m, y_m in points)
        joint = (here, *straight, there)
        return (*joint, *waypoints[k + 1 :]) if self._body_fits(joint) else ()

    def _body_fits(self, joint: tuple[Pose2, ...]) -> bool:
        """Whether the body keeps its clearance, less if it is nearer to something now, from here to a waypoint."""
        body = self.query.body
        if body is None:
            return True
        poses = poses_along(joint, self._foot_circle_m, 0.0, SPACING_M)
        apart_m = (self._occupied.distance_m(replace(body, pose=pose @ body.pose)) for pose in poses)
        required_m = min(self.query.body_clearance_m, next(apart_m) - SLACK_M)
        return all(distance_m >= required_m for distance_m in apart_m)


def _places(waypoints: tuple[Pose2, ...], here: Pose2) -> list[int]:
    """Indices of the waypoints that may be joined, in ascending order."""
    points = np.array([waypoint.xy() for waypoint in waypoints])
    nearest = int(np.hypot(*(points - here.xy()).T).argmin())
    ahead_m = arc_lengths_m(points[nearest:])
    wanted_m = np.arange(0.0, min(JOIN_WITHIN_M, float(ahead_m[-1])) + 1e-9, JOIN_EVERY_M)
    return sorted({nearest + int(k) for k in np.searchsorted(ahead_m, wanted_m).clip(0, len(ahead_m) - 1)})
