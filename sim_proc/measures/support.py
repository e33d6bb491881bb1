"""Distances of points on the floor to the border of the support polygon, the convex hull of the loaded feet."""

from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.conventions import LEGS

TINY: Final = float(np.finfo(np.float64).tiny)
AROUND: Final = tuple(LEGS.index(leg) for leg in ("FL", "FR", "RR", "RL"))
"""The feet in their order around the robot, as long as no legs cross."""
CORNERS: Final = np.array(
    [
        ([leg for leg in AROUND if code >> leg & 1] + [AROUND[0]] * len(AROUND))[: len(AROUND)]
        for code in range(1 << len(AROUND))
    ]
)
"""For each set of loaded feet, whose bits are 1, its feet in this order, and then others that do not count, (16, 4)."""


def support_margins(points_m: Floats, feet_m: Floats, loaded: Flags) -> Floats:
    """Signed distances of p points in each of n steps, (p, n, 2), to the border of the polygon of the step, (p, n).

    They are positive inside. `feet_m` (n, 4, 2) are the feet, and `loaded` (n, 4) says which of them carry the robot.
    The polygon of two feet is a segment, and that of one foot a point, so that no point is inside. If no foot is
    loaded, the distance is that to the mean of all feet.
    """
    margins = np.empty(points_m.shape[:2])
    legs = CORNERS[loaded @ (1 << np.arange(len(LEGS)))]
    n_loaded = loaded.sum(axis=1)
    for n_legs in np.flatnonzero(np.bincount(n_loaded)).tolist():
        steps = np.flatnonzero(n_loaded == n_legs)
        # Coordinates and corners come first, so that NumPy goes through the steps in its innermost loops.
        points = points_m[:, steps].transpose(2, 0, 1).copy()
        if n_legs:
            corners = feet_m[steps[:, None], legs[steps, :n_legs]].transpose(2, 1, 0).copy()
        else:
            corners = feet_m[steps].transpose(2, 1, 0).mean(axis=1, keepdims=True)
        if n_legs > 3:
            corners = _hulls(corners)
        margins[:, steps] = _margins(points, corners)
    return margins


def _cross(one: Floats, other: Floats) -> Floats:
    """Products of vectors in the plane, (2, ...)."""
    product: Floats = one[0] * other[1] - one[1] * other[0]
    return product


def _next(corners: Floats) -> Floats:
    """The corner after each corner, (2, k, n)."""
    return np.concatenate([corners[:, 1:], corners[:, :1]], axis=1)


def _turns(corners: Floats) -> Floats:
    """At each corner (2, k, n), twice the area of the triangle with its neighbours: positive to the left."""
    after = _next(corners) - corners
    return _cross(np.roll(after, 1, axis=1), after)


def _hulls(corners: Floats) -> Floats:
    """Corners of the convex hulls of four feet (2, 4, n), in their order around it.

    If a foot lies inside the triangle of the others, the middle of its neighbours takes its place.
    """
    turns = _turns(corners)
    crossed = np.flatnonzero((turns.min(axis=0) < 0.0) & (turns.max(axis=0) > 0.0))
    if len(crossed):
        some = corners[:, :, crossed]
        away = some - some.mean(axis=1, keepdims=True)
        order = np.arctan2(away[1], away[0]).argsort(axis=0)
        some = np.take_along_axis(some, order[None], axis=1)
        middles = (np.roll(some, 1, axis=1) + np.roll(some, -1, axis=1)) / 2
        corners[:, :, crossed] = np.where(_turns(some) < 0.0, middles, some)
    return corners


def _margins(points: Floats, corners: Floats) -> Floats:
    """Margins of points (2, p, n) in polygons whose k corners are in order, (2, k, n), for any k from 1 on: (p, n)."""
    edges = _next(corners) - corners
    n_corners = corners.shape[1]
    margins = np.full(points.shape[1:], -1.0)
    if n_corners > 2:
        # Twice the area of a triangle; of four corners in order, one of which may lie between its neighbours.
        turn = _cross(edges[:, 0], edges[:, 1]) + (_cross(edges[:, 2], edges[:, 3]) if n_corners > 3 else 0.0)
        lengths = np.sqrt(edges[0] * edges[0] + edges[1] * edges[1])
        along = edges * (np.sign(turn) / np.maximum(lengths, TINY))
        offsets = _cross(along, corners)
        np.minimum.reduce([_cross(along[:, k, None], points) - offsets[k] for k in range(n_corners)], out=margins)
        margins[:, turn == 0.0] = -1.0
    outside = margins < 0.0
    if outside.any():
        of, at = outside.nonzero()
        edge, away = edges[:, :, at], points[:, None, of, at] - corners[:, :, at]
        share = np.clip((edge * away).sum(axis=0) / np.maximum((edge * edge).sum(axis=0), TINY), 0.0, 1.0)
        off = away - share * edge
        margins[of, at] = -np.sqrt((off * off).sum(axis=0).min(axis=0))
    return margins
