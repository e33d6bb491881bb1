"""Fits the response surface of a face to random pushes, with the covariance of its residuals by depth."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from agent_proc.map_world.random_pushes import DEEPEST_M, LEAST_DEPTH_M, MeasuredSeries
from agent_proc.map_world.surface import Quality, Residuals, ResponseSurface
from agent_proc.push_model.curve_terms import curve_terms
from agent_proc.push_model.model import MIRROR
from legpush.arrays import Floats
from legpush.errors import ConfigError

ROWS_M: Final = (LEAST_DEPTH_M, 0.005, 0.01, 0.02, 0.04, 0.07, DEEPEST_M)
"""Depths of the rows of a surface, after depth 0. A foot that goes less deep does not reach the box."""
ENDS_M: Final = ROWS_M[1:]
"""Ends of the intervals of depth whose residuals have one covariance."""
N_FOLDS: Final = 10
LEAST_PER_INTERVAL: Final = 10
"""Fewest pushes in an interval from which a covariance is estimated."""
LEAST_SD: Final = 1e-7
"""Added to every standard deviation, in m and rad, so that a covariance without any scatter has a factor too."""
N_DIGITS: Final = 8


def fit_surface(series: Sequence[MeasuredSeries]) -> ResponseSurface:
    """The surface of the face that all series pushed, by least squares.

    Pushes of FR are used as mirror images of pushes of FL.

    Raises:
        ConfigError: There are too few pushes.
    """
    n_series = np.concatenate([np.full(len(each.pushes), index) for index, each in enumerate(series)])
    pushes = [push for each in series for push in each.pushes]
    mirror = np.array([MIRROR[push.leg] for push in pushes])
    depth, w1, w2, forward, left, turn = np.array(
        [(p.depth_m, p.w1, p.w2, p.forward_m, p.left_m, p.turn_rad) for p in pushes]
    ).T
    first = np.concatenate([np.arange(len(each.pushes)) == 0 for each in series])
    design = _design(depth, w1, w2, first)
    moved = np.stack([forward, mirror * left, mirror * turn], axis=1)
    if len(series) < 2 or (n_least := min(_counts(depth))) < LEAST_PER_INTERVAL:
        raise ConfigError(
            f"Expected at least {LEAST_PER_INTERVAL} pushes of every depth and two series at the {series[0].face} "
            f"face, got {0 if len(series) < 2 else n_least} and {len(series)}: measure more pushes"
        )
    coefficients = _least_squares(design, moved)
    residuals = moved - design @ coefficients
    forward_m, left_m, turn_rad = _rounded(np.vstack([np.zeros(3), coefficients[: len(ROWS_M)]]).T)
    return ResponseSurface(
        face=series[0].face,
        depth_m=(0.0, *ROWS_M),
        forward_m=forward_m,
        left_m=left_m,
        turn_rad=turn_rad,
        curve=_rounded(coefficients[len(ROWS_M) : -1].T),
        first=_rounded(coefficients[-1]),
        residuals=_residuals(depth, residuals, design.shape[1]),
        quality=_quality(n_series, mirror, design, moved, residuals),
    )


def _design(depth: Floats, w1: Floats, w2: Floats, first: Any) -> Floats:
    """One column for each coefficient: the rows, the terms of the curve, and the first push; (n, k)."""
    hats = [np.interp(depth, (0.0, *ROWS_M), column) for column in np.eye(len(ROWS_M) + 1)[1:]]
    columns: Floats = np.stack([*hats, *(depth * term for term in curve_terms(w1, w2)), first], axis=1)
    return columns


def _least_squares(design: Floats, moved: Floats) -> Floats:
    found: Floats = np.linalg.lstsq(design, moved)[0].astype(np.float64)
    return found


def _interval(depth: Floats) -> Any:
    """Index of the interval of `ENDS_M` of each depth."""
    return np.minimum(np.searchsorted(ENDS_M, depth), len(ENDS_M) - 1)


def _counts(depth: Floats) -> list[int]:
    counts: list[int] = np.bincount(_interval(depth), minlength=len(ENDS_M)).tolist()
    return counts


def _residuals(depth: Floats, residuals: Floats, n_coefficients: int) -> tuple[Residuals, ...]:
    """The covariance of each interval, for as many degrees of freedom as the fit leaves."""
    free = len(depth) / (len(depth) - n_coefficients)
    parts = []
    for index, end_m in enumerate(ENDS_M):
        mine = residuals[_interval(depth) == index]
        covariance = np.cov(mine, rowvar=False) * free + LEAST_SD**2 * np.eye(3)
        parts.append(Residuals(to_depth_m=end_m, n=len(mine), factor=_rounded(np.linalg.cholesky(covariance))))
    return tuple(parts)


def _quality(n_series: Any, mirror: Floats, design: Floats, moved: Floats, residuals: Floats) -> Quality:
    left_out = np.zeros_like(moved)
    for fold in range(N_FOLDS):
        out = n_series % N_FOLDS == fold
        left_out[out] = moved[out] - design[out] @ _least_squares(design[~out], moved[~out])
    legs = residuals[mirror > 0.0], residuals[mirror < 0.0]
    difference = legs[0].mean(axis=0) - legs[1].mean(axis=0)
    error = np.sqrt(sum(leg.var(axis=0, ddof=1) / len(leg) for leg in legs))
    return Quality(
        n=len(moved),
        r_squared=_rounded(1.0 - residuals.var(axis=0) / moved.var(axis=0)),
        cross_validated_rmse=_rounded(np.sqrt((left_out**2).mean(axis=0))),
        leg_difference=_rounded(difference),
        leg_difference_error=_rounded(error),
    )


def _rounded(array: NDArray[np.floating[Any]]) -> Any:
    """Nested tuples of an array, rounded."""
    return _tuples(array.round(N_DIGITS).tolist())


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
