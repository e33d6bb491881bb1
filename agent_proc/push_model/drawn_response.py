"""Draws what a push does to a box that nobody has pushed, from all that such boxes may do.

The curves that an estimate begins with are a distribution, and this draws from it: the expected curves, a part that is
common to both legs, and one that is opposite. Both parts are Ornstein-Uhlenbeck processes over the depth, so their
values are drawn one after the other.
"""

from math import exp, sqrt

import numpy as np

from agent_proc.push_model.curves import DEEP_M, Part, Spread
from agent_proc.push_model.model import PushModel, nearest_model
from agent_proc.push_model.response import MOST_LOST_M, Curve, Response, expected_curves, kind_of
from legpush.arrays import Floats
from legpush.scene.scenario import Box


def drawn_response(box: Box, random: np.random.Generator, model: PushModel | None = None) -> Response:
    """Draw a response around that of `model`, or of the nearest measured one; `box` has its size in the pushed frame.

    Its standard deviations of the turn are those of pushes around the drawn curves.
    """
    model = nearest_model(box) if model is None else model
    kind, depth_m = kind_of(box), np.array(model.depth_m)
    lost_m = min(float(random.exponential(kind.lost_mean_m)), MOST_LOST_M)
    spreads = (kind.forward, kind.left, kind.turn)
    drawn = [
        _drawn(expected, spread, depth_m, random)
        for expected, spread in zip(expected_curves(box, model), spreads, strict=True)
    ]
    turn_sd_rad = tuple(np.sqrt(kind.turn.variance(depth_m)).tolist())
    fl, fr = (
        Curve(forward_m=forward, left_m=left, turn_rad=turn, turn_sd_rad=turn_sd_rad)
        for forward, left, turn in zip(*drawn, strict=True)
    )
    return Response(depth_m=model.depth_m, curves=(fl, fr), w1=model.w1, w2=model.w2, lost_depth_m=lost_m)


def _drawn(
    expected: Floats, spread: Spread, depth_m: Floats, random: np.random.Generator
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The curves of FL, and the mirror image of those of FR."""
    common, opposite = (_part(part, depth_m, random) for part in (spread.common, spread.opposite))
    return tuple((expected + common + opposite).tolist()), tuple((expected + common - opposite).tolist())


def _part(part: Part, depth_m: Floats, random: np.random.Generator) -> Floats:
    """Values with the covariance of a part, (n,)."""
    normal = random.standard_normal(len(depth_m)).tolist()
    process = [normal[0]]
    for apart_m, value in zip(np.diff(depth_m).tolist(), normal[1:], strict=True):
        kept = exp(-apart_m / part.reach_m)
        process.append(kept * process[-1] + sqrt(1.0 - kept**2) * value)
    values: Floats = part.sd * (depth_m / DEEP_M) ** part.power * np.array(process)
    return values
