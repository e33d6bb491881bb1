"""A stage of the box's path, pushed at one face: where on it a pose is, and where it is straight."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from math import cos, hypot, radians, sin
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.planning import Plan
from legpush.scene.faces import pushed_pose
from legpush.scene.names import Face
from legpush.scene.paths import arc_lengths_m, nearest_on_segments

STRAIGHT_RAD_PER_M: Final = radians(5.0)
"""A path that curves less than this is straight."""
SAME_PLACE_M: Final = 1e-6


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """A pose relative to a path."""

    distance_m: float
    """Of the nearest point, along the path."""
    left_m: float
    """Distance to the left of the path, negative to the right."""
    heading_rad: float
    """Heading minus that of the path."""


class Stage:
    """Part of the box's path that is pushed at one face.

    Inside, the path is that of the axle, a point behind the centre of the box that does not slip sideways. Poses that
    the methods take and return are those of the centre, heading in the pushing direction.
    """

    def __init__(self, face: Face, poses: tuple[Pose2, ...], axle_m: float, end: Pose2 | None = None) -> None:
        """`poses` are those of the box in the plan; `end` is where it should end, if not at the last.

        Where they are all in one place, the stage has no length, and no pose can be compared with it.
        """
        self.face = face
        self._axle_m = axle_m
        behind = Pose2(x_m=-axle_m, y_m=0.0, yaw_rad=0.0)
        pushed = [pushed_pose(pose, face) @ behind for pose in poses]
        kept = [pushed[0]]
        for pose in pushed[1:]:
            if hypot(pose.x_m - kept[-1].x_m, pose.y_m - kept[-1].y_m) > SAME_PLACE_M:
                kept.append(pose)
        self.end = pushed_pose(poses[-1] if end is None else end, face)
        self._xy = np.array([pose.xy() for pose in kept])
        self._yaw = np.unwrap([pose.yaw_rad for pose in kept])
        self._at_m = arc_lengths_m(self._xy)
        self.length_m = float(self._at_m[-1])
        curved = np.abs(np.diff(self._yaw)) > STRAIGHT_RAD_PER_M * np.hypot(*np.diff(self._xy, axis=0).T)
        self._straight_until_m = np.empty(len(kept))
        end_m = self.length_m
        self._straight_until_m[-1] = end_m
        for index in range(len(kept) - 2, -1, -1):
            if curved[index]:
                end_m = float(self._at_m[index])
            self._straight_until_m[index] = end_m

    def pose(self, at_m: float) -> Pose2:
        """The pose at a distance along the path; straight on beyond its end."""
        within_m = min(max(at_m, 0.0), self.length_m)
        x_m, y_m = (float(np.interp(within_m, self._at_m, self._xy[:, axis])) for axis in (0, 1))
        yaw_rad = float(np.interp(within_m, self._at_m, self._yaw))
        beyond_m = max(0.0, at_m - self.length_m) + self._axle_m
        return Pose2(x_m=x_m + beyond_m * cos(yaw_rad), y_m=y_m + beyond_m * sin(yaw_rad), yaw_rad=yaw_rad)

    def straight_until_m(self, at_m: float) -> float:
        """Where the straight stretch around a place ends; `at_m` itself if the place is on an arc."""
        index = min(int(np.searchsorted(self._at_m, at_m + SAME_PLACE_M, side="right")) - 1, len(self._at_m) - 1)
        return max(float(self._straight_until_m[max(index, 0)]), at_m)

    def deviations(self, poses: Floats, from_m: float, to_m: float) -> tuple[Floats, Floats, Floats]:
        """Deviations of poses, (n, 3), from the path between two distances: along, left and heading, (n,) each."""
        low = int(np.searchsorted(self._at_m, from_m, side="right")) - 1
        high = max(int(np.searchsorted(self._at_m, to_m, side="left")) + 1, low + 2)
        low = min(max(low, 0), len(self._at_m) - 2)
        points, at = self._xy[low:high], self._at_m[low:high]
        heading = np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], axis=1)
        axles = poses[:, :2] - self._axle_m * heading
        lengths = np.diff(at)
        share, apart = nearest_on_segments(axles, points, lengths**2)
        nearest = apart.argmin(axis=1)
        rows = np.arange(len(poses))
        along = at[nearest] + share[rows, nearest] * lengths[nearest]
        yaw = np.interp(along, self._at_m, self._yaw)
        x, y = np.interp(along, self._at_m, self._xy[:, 0]), np.interp(along, self._at_m, self._xy[:, 1])
        left = np.cos(yaw) * (axles[:, 1] - y) - np.sin(yaw) * (axles[:, 0] - x)
        turn = poses[:, 2] - yaw
        return along, left, np.arctan2(np.sin(turn), np.cos(turn))

    def deviation(self, pose: Pose2, from_m: float, to_m: float) -> Deviation:
        """Deviation of one pose from the path between two distances."""
        along, left, heading = self.deviations(np.array([[pose.x_m, pose.y_m, pose.yaw_rad]]), from_m, to_m)
        return Deviation(distance_m=float(along[0]), left_m=float(left[0]), heading_rad=float(heading[0]))


def stages(plan: Plan, axles_m: Mapping[Face, float]) -> list[Stage]:
    """The stages of a planned path of the box; `axles_m` has the faces in the order of the query's sides."""
    found, faces = [], tuple(axles_m)
    numbered = list(zip(plan.sides, plan.waypoints, strict=True))
    for side, run in groupby(numbered, key=lambda item: item[0]):
        face = faces[side]
        found.append(Stage(face, tuple(pose for _, pose in run), axles_m[face]))
    return found
