"""Lengths of paths as waypoints or polylines, and distances of points from them."""

from collections.abc import Sequence

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle


def travelled_m(waypoints: Sequence[Pose2], foot_circle_m: float) -> Floats:
    """Return the length of a path up to each of its waypoints, (n,) with n > 0, from 0.

    Straight lines and uniform turns, the short way round, join the waypoints. A turn counts as the arc that the feet
    describe, on a circle of radius `foot_circle_m` about the trunk.
    """
    steps = np.diff(np.array([[pose.x_m, pose.y_m] for pose in waypoints]), axis=0)
    turns = np.diff(np.unwrap([pose.yaw_rad for pose in waypoints]))
    lengths = np.linalg.norm(steps, axis=1) + np.abs(turns) * foot_circle_m
    return np.concatenate([[0.0], np.cumsum(lengths)])


def path_length_m(waypoints: Sequence[Pose2], foot_circle_m: float) -> float:
    """Return the length of a whole path, turns included; 0 without waypoints."""
    return float(travelled_m(waypoints, foot_circle_m)[-1]) if waypoints else 0.0


def poses_along(waypoints: Sequence[Pose2], foot_circle_m: float, from_m: float, step_m: float) -> tuple[Pose2, ...]:
    """Return the poses of a path from a travelled length on, one each `step_m`, and its end."""
    at_m = travelled_m(waypoints, foot_circle_m)
    where = np.append(np.arange(min(from_m, at_m[-1]), at_m[-1], step_m), at_m[-1])
    yaws = np.unwrap([p.yaw_rad for p in waypoints])
    columns = ([p.x_m for p in waypoints], [p.y_m for p in waypoints], yaws)
    poses = np.stack([np.interp(where, at_m, column) for column in columns], axis=1)
    return tuple(Pose2(x_m=x_m, y_m=y_m, yaw_rad=wrap_angle(yaw_rad)) for x_m, y_m, yaw_rad in poses.tolist())


def arc_lengths_m(polyline_m: Floats) -> Floats:
    """Return the length of a polyline, (n, 2) with n > 0, up to each of its vertices, (n,), from 0."""
    steps = np.diff(polyline_m, axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])


def distances_m(points_m: Floats, polyline_m: Floats) -> Floats:
    """Return the distance of each point, (k, 2), from a polyline, (n, 2) with n > 0; (k,)."""
    line_m = polyline_m if len(polyline_m) > 1 else np.repeat(polyline_m, 2, axis=0)
    squared_lengths = (np.diff(line_m, axis=0) ** 2).sum(axis=1)
    _, distances = nearest_on_segments(points_m, line_m, squared_lengths)
    nearest: Floats = distances.min(axis=1)
    return nearest


def nearest_on_segments(points_m: Floats, polyline_m: Floats, squared_lengths: Floats) -> tuple[Floats, Floats]:
    """Return the nearest place to each point, (k, 2), on each segment of a polyline, (n, 2) with n > 1.

    A place is the share of the segment that lies before it, from 0 to 1, and its distance; both are (k, n - 1).
    `squared_lengths` are those of the segments, (n - 1,).
    """
    edges_m = np.diff(polyline_m, axis=0)
    offsets_m = points_m[:, None] - polyline_m[:-1]
    share = (offsets_m * edges_m).sum(axis=-1) / np.where(squared_lengths > 0.0, squared_lengths, 1.0)
    share = np.clip(share, 0.0, 1.0)
    apart_m = offsets_m - share[..., None] * edges_m
    return share, np.hypot(apart_m[..., 0], apart_m[..., 1])
