"""The value of every pose of the box near its goal: the least cost of pushes from there, with the error they leave.

A push moves the box ahead. So the table is filled once, backwards from beyond the goal, slice by slice of the distance
ahead. The value of a pose is that of stopping there, or of its best push: what is known of where the box comes to then
is interpolated (Bellman's principle; Bertsekas, *Dynamic Programming and Optimal Control*, ch. 1).
"""

from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from agent_proc.push_model.model import MIRROR
from agent_proc.push_model.response import Response
from legpush.arrays import Floats, Indices
from legpush.scene.conventions import FRONT_LEGS

CYCLE_COST: Final = 0.01
"""Cost of each push cycle, in tolerances of the final error (our choice, as all below)."""
MOST_TURN_RAD: Final = float(np.radians(20.0))
"""A push that turns the box by more leaves it where the robot may not reach it with its next step."""
TURN_COST: Final = 20.0
"""Cost of twice that turn, in tolerances, beyond which it grows in proportion."""
BEYOND_SHARE: Final = 0.9
"""Cost of being beyond the borders of the table, as a share of what the errors grow by there: to stop costs more."""
PAST_M: Final = (0.1, 0.05, 0.025, 0.012, 0.005, 0.0)
NEAR_M: Final = (0.003, 0.006, 0.009, 0.013, 0.02, 0.03, 0.042, 0.056, 0.072, 0.09)
FAR_M: Final = (0.11, 0.025, 0.45, 0.04, 1.8)
"""Slices past the goal and before it; the far ones as first, step, then, step, end."""
N_SIDE: Final = 41
MOST_SIDE_M: Final = 0.5
N_TURN: Final = 41
MOST_TURNED_RAD: Final = float(np.radians(70.0))
SIDE_GROWTH: Final = 3.0
TURN_GROWTH: Final = 2.5
"""Places beside the goal and headings are denser near zero, as a hyperbolic sine is."""
N_DEPTHS: Final = 10
LEAST_STEP_SHARE: Final = 0.5
"""A push counts if it moves the box by this share of the way between two slices: a shorter one stays where the values
are interpolated, and would seem to cost nothing again and again."""

FAR_OFF_SD: Final = 3.0
FAR_OFF_WEIGHT: Final = 1 / (2 * FAR_OFF_SD**2)
"""A push turns the box as it should, or by this many standard deviations more or less, each with this probability: that
has the mean and variance of what it does. What is rare but hard to mend counts so."""

CAREFREE_RAD: Final = 0.01
"""This much of the standard deviation of a turn is left out: what the next pushes mend as they go needs no caution."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What values depend on."""

    response: Response
    least_m: float
    most_m: float
    """Depths of pushes, without what this box loses of them."""
    near_m: float
    near_rad: float
    """Tolerances of the goal."""

    def error(self, x_m: Floats, y_m: Floats, yaw_rad: Floats) -> Floats:
        """Norm of both errors in tolerances, in the frame of the goal."""
        norm: Floats = np.hypot(np.hypot(x_m, y_m) / self.near_m, yaw_rad / self.near_rad)
        return norm

    def beyond(self, by_m: ArrayLike, by_rad: ArrayLike) -> Floats:
        """Cost of being beyond the borders of a table."""
        cost: Floats = BEYOND_SHARE * (np.asarray(by_m) / self.near_m + np.asarray(by_rad) / self.near_rad)
        return cost

    def pushes(self, n_depths: int) -> tuple[Floats, Floats]:
        """Mirror and depth of pushes with both legs, (2 n_depths,); shallow ones are denser."""
        depths = self.least_m + (self.most_m - self.least_m) * np.square(np.linspace(0.0, 1.0, n_depths))
        mirror, depth_m = np.array(list(product([MIRROR[leg] for leg in FRONT_LEGS], depths))).T
        return mirror, depth_m


class ValueTable:
    """Values on a grid of poses of the box in the frame of its goal. Slices are filled as far as poses ask for."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._x = _slices()
        self._y = _dense(N_SIDE, MOST_SIDE_M, SIDE_GROWTH)
        self._yaw = _dense(N_TURN, MOST_TURNED_RAD, TURN_GROWTH)
        self._step = _Step(problem, self._y, self._yaw)
        self._n_filled = 0
        self._values = np.empty((len(self._x), N_TURN, N_SIDE))
        self._after = np.empty((len(self._x), *self._step.shape))

    def costs(self, pose: tuple[float, float, float], response: Response, mirror: Floats, depth_m: Floats) -> Floats:
        """Cost of pushing once and then as well as possible, by each push, (n,); depths are without what is lost.

        It is infinite for pushes that are too short for the table, if there are others.
        """
        forward, left, turn = response.displacement(mirror, depth_m)
        x_m, y_m, yaw_rad = pose
        c, s = np.cos(yaw_rad), np.sin(yaw_rad)
        ahead = c * forward - s * left
        sd = _feared_sd(response, mirror, depth_m)
        costs = _push_cost(turn, sd)
        for turned, weight in _turns(turn, sd):
            costs = costs + weight * self._at(x_m + ahead, y_m + s * forward + c * left, yaw_rad + turned)
        index = int(_Place.on(self._x, np.array([x_m])).index[0])
        moves = ahead >= LEAST_STEP_SHARE * (self._x[index] - self._x[index + 1])
        return np.where(moves, costs, np.inf) if moves.any() else costs

    def _at(self, x_m: Floats, y_m: Floats, yaw_rad: Floats) -> Floats:
        """Value at poses, (n,); beyond the table, that at its border and what it costs to be beyond."""
        place = _Place.on(self._x, x_m)
        self._fill(int(place.index.max()) + 2)
        flat = _Plane(self._y, self._yaw, y_m, yaw_rad)
        near, far = flat.of(self._values, place.index), flat.of(self._values, place.index + 1)
        problem, past_m = self._problem, np.maximum(x_m - self._x[0], 0.0)
        value: Floats = near + place.share * (far - near) + problem.beyond(past_m, 0.0) + flat.beyond(problem)
        return value

    def _fill(self, n_slices: int) -> None:
        """Fill the first slices, those from beyond the goal on."""
        x, step = self._x, self._step
        yaw_grid, y_grid = np.meshgrid(self._yaw, self._y, indexing="ij")
        row, column = np.arange(len(step.ahead))[:, None], np.arange(N_TURN)[None]
        for n in range(self._n_filled, n_slices):
            values = self._problem.error(np.full_like(y_grid, x[n]), y_grid, yaw_grid)
            if n:
                place = _Place.on(x[:n], x[n] + step.ahead)
                near = self._after[place.index, row, column]
                far = self._after[np.minimum(place.index + 1, n - 1), row, column]
                found = near + place.share[:, :, None] * (far - near) + step.cost
                moves = step.ahead >= LEAST_STEP_SHARE * (x[n - 1] - x[n])
                values = np.minimum(values, np.where(moves[:, :, None], found, np.inf).min(axis=0))
            self._values[n] = values
            self._after[n] = step.expected(values)
        self._n_filled = max(self._n_filled, n_slices)


class _Step:
    """Where pushes lead from every heading and place beside the goal, (pushes, headings, places)."""

    def __init__(self, problem: Problem, y: Floats, yaw: Floats) -> None:
        mirror, depth_m = problem.pushes(N_DEPTHS)
        forward, left, turn = (each[:, None] for each in problem.response.displacement(mirror, depth_m))
        sd = _feared_sd(problem.response, mirror, depth_m)[:, None]
        c, s = np.cos(yaw), np.sin(yaw)
        y_m = y + (s * forward + c * left)[:, :, None]
        self.shape = y_m.shape
        self.ahead = c * forward - s * left
        """How far the box comes nearer, (pushes, headings)."""
        self._feared = sd[:, 0] > 0.0
        (as_it_should, _), *far_off = _turns(turn, sd)
        middle = _Plane(y, yaw, y_m, (yaw + as_it_should)[:, :, None])
        self._middle = middle.matrix()
        self._far_off = [
            _Plane(y, yaw, y_m[self._feared], (yaw + turned)[self._feared][:, :, None]).matrix()
            for turned, _ in far_off
        ]
        self.cost = _push_cost(turn, sd)[:, :, None] + middle.beyond(problem)

    def expected(self, values: Floats) -> Floats:
        """Mean of the values (yaw, y) where a push leads to; where no turn is feared, it turns as it should."""
        found: Floats = (self._middle @ values.ravel()).reshape(self.shape)
        feared = (1.0 - len(self._far_off) * FAR_OFF_WEIGHT) * found[self._feared]
        for matrix in self._far_off:
            feared += FAR_OFF_WEIGHT * (matrix @ values.ravel()).reshape(feared.shape)
        found[self._feared] = feared
        return found


@dataclass(frozen=True, kw_only=True)
class _Place:
    """Between which slices coordinates are."""

    index: Indices
    share: Floats

    @classmethod
    def on(cls, x: Floats, x_m: Floats) -> "_Place":
        """Those of coordinates on descending slices; the nearest end, where they are beyond."""
        index = np.clip(np.searchsorted(-x, -x_m, side="right") - 1, 0, max(len(x) - 2, 0))
        if len(x) == 1:
            return cls(index=index, share=np.zeros_like(x_m))
        return cls(index=index, share=np.clip((x[index] - x_m) / (x[index] - x[index + 1]), 0.0, 1.0))


class _Plane:
    """Bilinear interpolation in a slice, at places beside the goal and headings."""

    def __init__(self, y: Floats, yaw: Floats, y_m: Floats, yaw_rad: Floats) -> None:
        self._j, self._v = _between(y, y_m)
        self._k, self._w = _between(yaw, yaw_rad)
        self._n = (len(yaw), len(y))
        self._beyond_m = np.maximum(np.abs(y_m) - y[-1], 0.0)
        self._beyond_rad = np.maximum(np.abs(yaw_rad) - yaw[-1], 0.0)

    def beyond(self, problem: Problem) -> Floats:
        """What it costs to be beyond the borders."""
        return problem.beyond(self._beyond_m, self._beyond_rad)

    def of(self, values: Floats, index: Indices) -> Floats:
        """Values at the places, (n,), each of the slice with its index; `values` are (x, yaw, y)."""
        j, k, v, w = self._j, self._k, self._v, self._w
        low = values[index, k, j] + w * (values[index, k + 1, j] - values[index, k, j])
        high = values[index, k, j + 1] + w * (values[index, k + 1, j + 1] - values[index, k, j + 1])
        found: Floats = low + v * (high - low)
        return found

    def matrix(self) -> csr_array:
        """What takes the values of a slice (yaw, y) to those at the places. Its sums are in order, without BLAS."""
        n_turn, n_side = self._n
        first = self._k * n_side + self._j
        indices = np.stack([first, first + 1, first + n_side, first + n_side + 1], axis=-1)
        v, w = np.broadcast_arrays(self._v, self._w)
        weights = np.stack([(1 - w) * (1 - v), (1 - w) * v, w * (1 - v), w * v], axis=-1)
        starts = 4 * np.arange(first.size + 1)
        return csr_array((weights.ravel(), indices.ravel(), starts), shape=(first.size, n_turn * n_side))


def _between(grid: Floats, value: Floats) -> tuple[Indices, Floats]:
    index = np.clip(np.searchsorted(grid, value) - 1, 0, len(grid) - 2)
    return index, np.clip((value - grid[index]) / (grid[index + 1] - grid[index]), 0.0, 1.0)


def _feared_sd(response: Response, mirror: Floats, depth_m: Floats) -> Floats:
    """Standard deviations of turns that are planned with, (n,)."""
    feared: Floats = np.maximum(response.turn_sd_rad(mirror, depth_m) - CAREFREE_RAD, 0.0)
    return feared


def _turns(turn_rad: Floats, sd_rad: Floats) -> list[tuple[Floats, float]]:
    """Turns that a push may do, and their probabilities."""
    by_rad, middle = FAR_OFF_SD * sd_rad, 1.0 - 2 * FAR_OFF_WEIGHT
    return [(turn_rad, middle), (turn_rad - by_rad, FAR_OFF_WEIGHT), (turn_rad + by_rad, FAR_OFF_WEIGHT)]


def _push_cost(turn_rad: Floats, sd_rad: Floats) -> Floats:
    cost: Floats = np.full_like(turn_rad, CYCLE_COST)
    for turned, weight in _turns(turn_rad, sd_rad):
        cost = cost + weight * TURN_COST * np.maximum(np.abs(turned) / MOST_TURN_RAD - 1.0, 0.0)
    return cost


def _slices() -> Floats:
    """Descending distances ahead of the goal."""
    first, step, then, last_step, end = FAR_M
    before_m = np.concatenate([NEAR_M, np.arange(first, then, step), np.arange(then, end, last_step)])
    return np.concatenate([PAST_M, -before_m])


def _dense(n: int, most: float, growth: float) -> Floats:
    """`n` values from -most to most, denser near zero."""
    steps: Floats = np.sinh(growth * np.linspace(-1.0, 1.0, n)) / np.sinh(growth)
    return most * steps
