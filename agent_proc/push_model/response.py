"""What one push does to a box: the push model, with coefficients that are fitted to the pushes up to now.

In the model the legs do mirror images of each other, and displacements have one shape over the depth. A centre of mass
beside the middle, or a slope across the way, makes the legs differ. A round or heavy box yields less and less as a push
goes on. The coefficients are taken to be constant but for a slow random walk, and a Kalman filter estimates them.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from agent_proc.push_model.model import MIRROR, PushModel, nearest_model
from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.stepping import Push
from legpush.scene.scenario import Box

DEFAULT_MODEL: Final = PushModel()
LONG_M: Final = 0.07
"""Displacement at which the coefficient of a growing part counts once (our choice, as all below)."""
FORWARD_SD: Final = (0.3, 0.3)
LEFT_SD: Final = (0.7, 0.3, 0.6)
TURN_SD: Final = (0.5, 1.5, 0.6)
"""Standard deviations of the coefficients before the first push."""
NOISE_M: Final = 0.003
NOISE_RAD: Final = 0.01
"""Standard deviations of the displacement by one push around what the coefficients say."""
WALK_SHARE: Final = 0.03
"""Standard deviation by which a coefficient may change from one push to the next, in its first ones."""
LEAST_FORWARD_M: Final = 0.002
"""A push that would move the box of the model by less says nothing about coefficients."""


@dataclass(frozen=True, kw_only=True)
class Response:
    """Displacement of a box by one push, in the pushed frame before it.

    With f, l and t of the model, and g = f / `LONG_M`: forward is a f + b f g, left a l + b f + c l g, and turn
    a t + b f + c t g.
    """

    model: PushModel = DEFAULT_MODEL
    forward: tuple[float, float] = (1.0, 0.0)
    left: tuple[float, float, float] = (1.0, 0.0, 0.0)
    turn: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """The second coefficient in rad/m."""

    def displacement(self, mirror: Floats, depth_m: Floats) -> tuple[Floats, Floats, Floats]:
        """Forward [m], left [m] and turn [rad], (n,) each; arguments as in `PushModel.push`, without lost depth."""
        seen = Effects.of(self.model, mirror, depth_m)
        forward: Floats = np.maximum(_sum(self.forward, seen.forward), 0.0)
        return forward, _sum(self.left, seen.left), _sum(self.turn, seen.turn)


@dataclass(frozen=True, kw_only=True)
class Effects:
    """What the coefficients of each part of a displacement multiply, (n,) each."""

    forward: tuple[Floats, ...]
    left: tuple[Floats, ...]
    turn: tuple[Floats, ...]

    @classmethod
    def of(cls, model: PushModel, mirror: Floats, depth_m: Floats) -> "Effects":
        """Those of pushes of the model."""
        forward = np.interp(depth_m, model.depth_m, model.forward_m)
        left = mirror * np.interp(depth_m, model.depth_m, model.left_m)
        turn = mirror * np.radians(np.interp(depth_m, model.depth_m, model.turn_deg))
        grown = forward / LONG_M
        return cls(
            forward=(forward, forward * grown),
            left=(left, forward, left * grown),
            turn=(turn, forward, turn * grown),
        )


class ResponseEstimate:
    """Fits a response to pushes, beginning with what is expected."""

    def __init__(self, expected: Response) -> None:
        self._model = expected.model
        self._forward = _Coefficients(expected.forward, FORWARD_SD, NOISE_M)
        self._left = _Coefficients(expected.left, LEFT_SD, NOISE_M)
        self._turn = _Coefficients(expected.turn, TURN_SD, NOISE_RAD)

    @property
    def response(self) -> Response:
        """The present estimate."""
        (a, b), left, turn = self._forward.values, self._left.values, self._turn.values
        return Response(
            model=self._model, forward=(a, b), left=(left[0], left[1], left[2]), turn=(turn[0], turn[1], turn[2])
        )

    def learn(self, push: Push, yielded_m: float, moved: Pose2) -> None:
        """Update the coefficients; `yielded_m` is the depth without what the box loses of it, `moved` what it did."""
        seen = Effects.of(self._model, np.array([MIRROR[push.leg]]), np.array([yielded_m]))
        if float(seen.forward[0][0]) < LEAST_FORWARD_M:
            return
        self._forward.learn(seen.forward, moved.x_m)
        self._left.learn(seen.left, moved.y_m)
        self._turn.learn(seen.turn, wrap_angle(moved.yaw_rad))


def expected_response(box: Box, model: PushModel | None = None) -> Response:
    """The response of a box that has not been pushed, over `model` or the nearest measured one.

    `box` has its size in the pushed frame.
    """
    model = nearest_model(box) if model is None else model
    return Response(model=model, turn=(_turn_per_travel(box) / _turn_per_travel(model.box), 0.0, 0.0))


def _turn_per_travel(box: Box) -> float:
    """Turn per travel [1/m] of a box that is pushed at the usual share of its width, up to a constant factor.

    It assumes a box that rests on its corners: a push turns it in proportion to the arm of the push over the squared
    distance of the corners from the centre.
    """
    length_m, width_m, _ = box.size_m
    return width_m / (length_m**2 + width_m**2)


class _Coefficients:
    """Coefficients of one part of a displacement, with their covariance."""

    def __init__(self, values: tuple[float, ...], sd: tuple[float, ...], noise: float) -> None:
        self._values = np.array(values)
        self._covariance = np.diag(np.square(sd))
        self._walk = np.diag(np.square(WALK_SHARE * np.array(sd)))
        self._variance = noise**2

    @property
    def values(self) -> list[float]:
        return [float(value) for value in self._values]

    def learn(self, effects: tuple[Floats, ...], measured: float) -> None:
        """Sums are elementwise and in order, without BLAS, so that they have the same bits everywhere."""
        seen = np.array([float(effect[0]) for effect in effects])
        covariance = self._covariance + self._walk
        spread = (covariance * seen).sum(axis=1)
        gain = spread / (float((seen * spread).sum()) + self._variance)
        self._values = self._values + gain * (measured - float((seen * self._values).sum()))
        self._covariance = covariance - gain[:, None] * spread


def _sum(coefficients: tuple[float, ...], effects: tuple[Floats, ...]) -> Floats:
    total: Floats = np.zeros(1)
    for coefficient, effect in zip(coefficients, effects, strict=True):
        total = total + coefficient * effect
    return total
