"""Shortens a motion of the body: longer straight lines, fewer turns."""

from math import atan2, pi
from typing import Final

import numpy as np

from legpush.arrays import Floats
from planner_proc.body.motion import cost_m
from planner_proc.body.space import BodySpace

_NEXT_SPAN: Final = 0.75
"""How much shorter the next part is that is tried."""
_SAME_M: Final = 1e-9


def shortened(poses: Floats, space: BodySpace) -> Floats:
    """A motion with the same ends that costs no more, (k, 3); from each pose on, as far as a simple one leads."""
    kept = [poses[0]]
    k = 0
    while k < len(poses) - 1:
        span = len(poses) - 1 - k
        while span > 1 and (simple := _simple(poses[k : k + span + 1], space)) is None:
            span = int(_NEXT_SPAN * span)
        kept.extend(simple[1:] if span > 1 and simple is not None else poses[k + 1 : k + 2])
        k += max(span, 1)
    return np.array(kept)


def _simple(poses: Floats, space: BodySpace) -> Floats | None:
    """The cheapest free one of the simple motions between the ends of a motion that cost less; None if there is none.

    They are a straight line with a uniform turn, and a turn, a line ahead or back, and a turn.
    """
    begin, end = poses[0], poses[-1]
    move = end - begin
    candidates = [np.array([begin, end])]
    if np.hypot(move[0], move[1]) > _SAME_M:
        ahead_rad = atan2(move[1], move[0])
        candidates += [
            np.array([begin, [*begin[:2], yaw_rad], [*end[:2], yaw_rad], end])
            for yaw_rad in (ahead_rad, ahead_rad + pi)
        ]
    present_m = cost_m(poses, space.reach_m)
    costed = sorted(((cost_m(each, space.reach_m), k) for k, each in enumerate(candidates)))
    for cost, k in costed:
        if cost < present_m - _SAME_M and space.is_free(candidates[k]):
            return candidates[k]
    return None
