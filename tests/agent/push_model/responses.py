"""Responses of made-up boxes."""

import numpy as np

from agent_proc.push_model.model import MIRROR, PushModel
from agent_proc.push_model.response import Curve, Response
from legpush.geometry import Pose2
from legpush.scene.conventions import FRONT_LEGS, FrontLeg

LONG_M = 0.07


def response_with(
    forward: tuple[float, float] = (1.0, 0.0),
    left: tuple[float, float, float] = (1.0, 0.0, 0.0),
    turn: tuple[float, float, float] = (1.0, 0.0, 0.0),
    lost_m: float = 0.0,
) -> Response:
    """A box that is told from that of the model by coefficients.

    With f, l and t of the model, and g = f / `LONG_M`: it moves forward by a f + b f g and left by a l + b f + c l g,
    and turns by a t + b f + c t g.
    """
    model = PushModel()
    f, t = np.array(model.forward_m), np.radians(model.turn_deg)
    side, g = np.array(model.left_m), np.array(model.forward_m) / LONG_M
    curves = []
    for leg in FRONT_LEGS:
        own = MIRROR[leg] * f
        curves.append(
            Curve(
                forward_m=tuple((forward[0] * f + forward[1] * f * g).tolist()),
                left_m=tuple((left[0] * side + left[1] * own + left[2] * side * g).tolist()),
                turn_rad=tuple((turn[0] * t + turn[1] * own + turn[2] * t * g).tolist()),
                turn_sd_rad=(0.0,) * len(f),
            )
        )
    fl, fr = curves
    return Response(depth_m=model.depth_m, curves=(fl, fr), w1=model.w1, w2=model.w2, lost_depth_m=lost_m)


def displaced(response: Response, leg: FrontLeg, depth_m: float) -> Pose2:
    """Where one push moves the box from its pose."""
    yielded_m = max(depth_m - response.lost_depth_m, 0.0)
    forward, left, turn = response.displacement(np.array([MIRROR[leg]]), np.array([yielded_m]))
    return Pose2(x_m=float(forward[0]), y_m=float(left[0]), yaw_rad=float(turn[0]))
