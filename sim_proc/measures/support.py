"""Distances of points on the floor to the border of the support polygon, the convex hull of the loaded feet."""

from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.conventions import LEGS

TINY: Final = float(np.finfo(np.float64).tiny)
_BITS: Final = 1 << np.arange(len(LEGS))


def support_margins(points_m: Floats, feet_m: Floats, loaded: Flags) -> Floats:
    """Signed distances of p points in each of n steps, (p, n, 2), to the border of the polygon of the step, (p, n).

    They are positive inside. `feet_m` (n, 4, 2) are the feet, and `loaded` (n, 4) says which of them carry the robot.
    The polygon of two feet is a segment, and that of one foot a point, so that no point is inside. If no foot is
    loaded, the distance is that to the mean of all feet.
    """
    x, y = points_m.transpose(2, 0, 1)
    feet_x, feet_y = np.ascontiguousarray(feet_m.transpose(2, 1, 0))
    margins = np.empty(x.shape)
    sets = loaded @ _BITS
    for code in np.flatnonzero(np.bincount(sets)).tolist():
        steps = np.flatnonzero(sets == code)
        legs = [leg for leg in range(len(LEGS)) if code >> leg & 1]
        ring_x, ring_y = (values[legs][:, steps] for values in (feet_x, feet_y))
        if not legs:
            ring_x, ring_y = (values[:, steps].mean(axis=0, keepdims=True) for values in (feet_x, feet_y))
        elif len(legs) > 3:
            ring_x, ring_y = _hull(ring_x, ring_y)
        margins[:, steps] = _margins(x[:, steps], y[:, steps], ring_x, ring_y)
    return margins


def _hull(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Four corners (4, n) in counterclockwise order about their mean.

    If one lies inside the triangle of the others, the middle of its neighbours takes its place.
    """
    order = np.arctan2(y - y.mean(axis=0), x - x.mean(axis=0)).argsort(axis=0)
    x, y = (np.take_along_axis(values, order, axis=0) for values in (x, y))
    before, after = (
        [np.roll(values, 1, axis=0) for values in (x, y)],
        [np.roll(values, -1, axis=0) for values in (x, y)],
    )
    turn = (x - before[0]) * (after[1] - y) - (y - before[1]) * (after[0] - x)
    hollow = turn < 0.0
    if hollow.any():
        x, y = (np.where(hollow, (b + a) / 2, own) for own, b, a in zip((x, y), before, after, strict=True))
    return x, y


def _margins(x: Floats, y: Floats, corners_x: Floats, corners_y: Floats) -> Floats:
    """Margins of points (p, n) in polygons whose k corners are in order, (k, n), for any k from 1 on."""
    edge_x, edge_y = (np.roll(corners, -1, axis=0) - corners for corners in (corners_x, corners_y))
    away_x, away_y = x[:, None] - corners_x, y[:, None] - corners_y
    inside = np.full(x.shape, -1.0)
    if len(corners_x) > 2:
        # Two of the edges lie in one line if one of four corners does not count.
        turn = edge_x[0] * edge_y[1] - edge_y[0] * edge_x[1] + edge_x[-2] * edge_y[-1] - edge_y[-2] * edge_x[-1]
        lengths = np.maximum(np.hypot(edge_x, edge_y), TINY)
        inside = ((edge_x * away_y - edge_y * away_x) * (np.sign(turn) / lengths)).min(axis=1)
        inside[:, turn == 0.0] = -1.0
    outside = inside < 0.0
    if outside.any():
        of, at = outside.nonzero()
        ex, ey, ax, ay = edge_x[:, at], edge_y[:, at], away_x[of, :, at].T, away_y[of, :, at].T
        share = np.clip((ax * ex + ay * ey) / np.maximum(ex * ex + ey * ey, TINY), 0.0, 1.0)
        inside[of, at] = -np.hypot(ax - share * ex, ay - share * ey).min(axis=0)
    return inside
