"""Distances of points on the floor to the border of the support polygon, the convex hull of the loaded feet."""

from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.conventions import LEGS

TINY: Final = float(np.finfo(np.float64).tiny)
AROUND: Final = tuple(LEGS.index(leg) for leg in ("FL", "FR", "RR", "RL"))
"""The feet in their order around the robot, as long as no legs cross."""


def _corners(code: int) -> list[int]:
    """The feet in a set of feet, whose bits are 1, in their order around the robot; the last is repeated up to four."""
    loaded = [leg for leg in AROUND if code >> leg & 1] or [0]
    return loaded + loaded[-1:] * (len(LEGS) - len(loaded))


CORNERS: Final = np.array([_corners(code) for code in range(1 << len(LEGS))])
"""The corners of the polygon of each set of loaded feet, (16, 4)."""


def support_margins(points_m: Floats, feet_m: Floats, loaded: Flags) -> Floats:
    """Signed distances of p points in each of n steps, (p, n, 2), to the border of the polygon of the step, (p, n).

    They are positive inside. `feet_m` (n, 4, 2) are the feet, and `loaded` (n, 4) says which of them carry the robot.
    The polygon of two feet is a segment, and that of one foot a point, so that no point is inside. If no foot is
    loaded, the distance is that to the mean of all feet.
    """
    legs = CORNERS[loaded @ (1 << np.arange(len(LEGS)))]
    corners = np.take_along_axis(feet_m, legs[:, :, None], axis=1)
    flying = ~loaded.any(axis=1)
    if flying.any():
        corners[flying] = feet_m[flying].mean(axis=1, keepdims=True)
    # Coordinates and corners come first, so that NumPy goes through the steps in its innermost loops.
    return _margins(points_m.transpose(2, 0, 1).copy(), _hulls(corners.transpose(2, 1, 0).copy()))


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
    """Margins of points (2, p, n) in polygons whose four corners are in order, (2, 4, n): (p, n).

    Corners may be in the same place, one after the other: then the polygon is a triangle, a segment or a point.
    """
    edges = _next(corners) - corners
    # Twice the area; one of the corners may lie between its neighbours.
    turn = _cross(edges[:, 0], edges[:, 1]) + _cross(edges[:, 2], edges[:, 3])
    lengths = np.sqrt(edges[0] * edges[0] + edges[1] * edges[1])
    along = edges * (np.sign(turn) / np.maximum(lengths, TINY))
    offsets = np.where(lengths == 0.0, -np.inf, _cross(along, corners))
    margins: Floats = _cross(along[:, 0, None], points) - offsets[0]
    for k in range(1, len(LEGS)):
        np.minimum(margins, _cross(along[:, k, None], points) - offsets[k], out=margins)
    margins[:, turn == 0.0] = -1.0
    outside = margins < 0.0
    if outside.any():
        of, at = outside.nonzero()
        edge, away = edges[:, :, at], points[:, None, of, at] - corners[:, :, at]
        share = np.clip((edge * away).sum(axis=0) / np.maximum((edge * edge).sum(axis=0), TINY), 0.0, 1.0)
        off = away - share * edge
        margins[of, at] = -np.sqrt((off * off).sum(axis=0).min(axis=0))
    return margins
