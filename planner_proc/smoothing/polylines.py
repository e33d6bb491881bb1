"""Measures and samples of polylines, which are arrays of vertices, (n, 2), in metres."""

import numpy as np

from legpush.arrays import Floats
from legpush.scene.paths import arc_lengths_m


def length(points: Floats) -> float:
    """Length of the whole polyline."""
    return float(arc_lengths_m(points)[-1])


def at(points: Floats, vertices_at: Floats, where: Floats) -> Floats:
    """Points of a polyline, (k, 2), at the arc lengths `where`, (k,); its vertices are at `vertices_at`, (n,)."""
    return np.stack([np.interp(where, vertices_at, points[:, axis]) for axis in (0, 1)], axis=-1)


def subdivide(points: Floats, spacing: float) -> Floats:
    """Add vertices to a polyline, so that consecutive ones are at most `spacing` apart."""
    vertices_at = arc_lengths_m(points)
    n_parts = np.maximum(1, np.ceil(np.diff(vertices_at) / spacing)).astype(int)
    legs = zip(vertices_at[:-1], vertices_at[1:], n_parts, strict=True)
    where = [np.linspace(begin, end, n, endpoint=False) for begin, end, n in legs]
    return at(points, vertices_at, np.concatenate([*where, vertices_at[-1:]]))


def headings(points: Floats) -> Floats:
    """Direction of travel at each vertex, (n,): that of the segment at the ends, and the middle of both in between."""
    steps = np.diff(points, axis=0)
    directions = np.arctan2(steps[:, 1], steps[:, 0])
    between = directions[:-1] + 0.5 * turns(points)
    return np.concatenate([directions[:1], between, directions[-1:]])


def turns(points: Floats) -> Floats:
    """Change of direction at each inner vertex, (n - 2,), in [-pi, pi)."""
    steps = np.diff(points, axis=0)
    changes: Floats = (np.diff(np.arctan2(steps[:, 1], steps[:, 0])) + np.pi) % (2.0 * np.pi) - np.pi
    return changes


def turning_radii(points: Floats) -> Floats:
    """Radii of the circles through each inner vertex and its neighbours, (n - 2,); infinite on a straight line."""
    steps = np.diff(points, axis=0)
    a, b = np.hypot(*steps[:-1].T), np.hypot(*steps[1:].T)
    c = np.hypot(*(points[2:] - points[:-2]).T)
    twice_area = np.abs(steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0])
    with np.errstate(divide="ignore"):
        radii: Floats = np.where(twice_area > 1e-12 * a * b, a * b * c / (2.0 * np.maximum(twice_area, 1e-300)), np.inf)
    return radii
