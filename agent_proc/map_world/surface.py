"""The response surface of a face: displacement of the box by one push, by leg, depth and curve, with residuals."""

from functools import cached_property
from typing import Annotated

import numpy as np
from msgspec import Meta, Struct
from numpy.typing import ArrayLike

from agent_proc.push_model.curve_terms import Terms, curve_terms
from legpush.arrays import Floats
from legpush.scene.names import Face

Triple = tuple[float, float, float]
"""Forward [m], left [m] and turn [rad], in the pushed frame before the push; of FL, and of FR the mirror image."""
Rows = Annotated[tuple[float, ...], Meta(min_length=2)]


class Residuals(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the surface does not explain of the pushes in an interval of depths."""

    to_depth_m: float
    """End of the interval, which begins at the end of the one before."""
    n: int
    """Number of pushes."""
    factor: tuple[Triple, Triple, Triple]
    """Lower Cholesky factor of the covariance of forward, left and turn."""

    @property
    def covariance(self) -> Floats:
        """Covariance of forward, left and turn, (3, 3)."""
        factor = np.array(self.factor)
        covariance: Floats = factor @ factor.T
        return covariance


class Quality(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How well the surface describes the pushes that it was fitted to."""

    n: int
    """Number of pushes."""
    r_squared: Triple
    """Share of the variance that is explained, without a unit."""
    cross_validated_rmse: Triple
    """Root mean square error of pushes in series that were left out of the fit."""
    leg_difference: Triple
    """Mean residual of FL minus that of FR: both are described by one surface and its mirror image."""
    leg_difference_error: Triple
    """Standard error of that difference."""


class ResponseSurface(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, dict=True):
    """Displacement of the pushed frame by one push of FL at a face; FR does the mirror image.

    It is linear in depth between the rows, which hold for w1 = w2 = 0.5. The curve adds the depth times a quadratic
    polynomial of w1 and w2.
    """

    face: Face
    depth_m: Rows
    """Depths of the rows, from 0 on."""
    forward_m: Rows
    """Displacement of the centre of the box along the pushing direction."""
    left_m: Rows
    """The same to the left of it."""
    turn_rad: Rows
    curve: tuple[Terms, Terms, Terms]
    """Coefficients of `CURVE_TERMS` for forward, left and turn."""
    first: Triple
    """Further displacement by the first push after a reset, when box and foot have another gap."""
    residuals: Annotated[tuple[Residuals, ...], Meta(min_length=1)]
    quality: Quality

    def __post_init__(self) -> None:
        """Check that the rows belong together.

        Raises:
            ValueError: They do not.
        """
        if not len(self.depth_m) == len(self.forward_m) == len(self.left_m) == len(self.turn_rad):
            raise ValueError("Expected as many values of forward_m, left_m and turn_rad as of depth_m")
        if self.depth_m[0] != 0.0 or not (np.diff(self.depth_m) > 0.0).all():
            raise ValueError(f"Expected depths that grow from 0 on, got {self.depth_m}")

    @property
    def deepest_m(self) -> float:
        """Depth of the deepest push that it describes."""
        return self.depth_m[-1]

    def displacement(
        self, mirror: Floats, depth_m: Floats, w1: Floats, w2: Floats, *, first: ArrayLike = False
    ) -> Floats:
        """Mean displacement by one push each: forward [m], left [m], turn [rad], (n, 3).

        `mirror` is 1 for FL and -1 for FR, and `first` whether it is the first push after a reset; all are (n,).
        """
        terms = curve_terms(w1, w2)
        first = np.asarray(first, dtype=np.float64)
        columns = []
        for rows, coefficients, more in zip(self._rows, self.curve, self.first, strict=True):
            # Added one after the other: no BLAS kernel decides about the last bit.
            slope = sum(c * term for c, term in zip(coefficients, terms, strict=True))
            columns.append(np.interp(depth_m, self.depth_m, rows) + depth_m * slope + first * more)
        forward, left, turn = columns
        moved: Floats = np.stack(np.broadcast_arrays(forward, mirror * left, mirror * turn), axis=-1)
        return moved

    def residual(self, mirror: Floats, depth_m: Floats, normal: Floats) -> Floats:
        """Residual of one push each, from independent standard normal numbers; both (n, 3)."""
        index = np.minimum(np.searchsorted(self._ends, depth_m), len(self.residuals) - 1)
        factor = self._factors[index]
        drawn: Floats = (factor * normal[..., None, :]).cumsum(axis=-1)[..., -1]
        drawn[..., 1:] *= mirror[..., None]
        return drawn

    @cached_property
    def _rows(self) -> tuple[Floats, Floats, Floats]:
        return np.array(self.forward_m), np.array(self.left_m), np.array(self.turn_rad)

    @cached_property
    def _ends(self) -> Floats:
        return np.array([part.to_depth_m for part in self.residuals])

    @cached_property
    def _factors(self) -> Floats:
        return np.array([part.factor for part in self.residuals])
