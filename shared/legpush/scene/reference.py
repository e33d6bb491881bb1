"""Curves that a box is pushed along: a sine, or a sequence of straight stretches and arcs (Figs. 20, 21)."""

from math import atan, ceil, hypot, pi
from typing import Annotated, Final

import numpy as np
from msgspec import Meta, Struct

from legpush.arrays import Floats
from legpush.bounds import MAX_LENGTH_M, Arc, Length, Periods, Wavelength
from legpush.geometry import Pose2

STEP_M: Final = 0.01
"""Largest distance between two points of a curve."""


class Sine(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="sine"):
    """y = amplitude sin(2 pi x / wavelength); x is turned so that the curve begins along the heading of the box."""

    amplitude_m: Length
    wavelength_m: Wavelength
    n_periods: Periods = 1.0

    def __post_init__(self) -> None:
        """Check the length of the curve.

        Raises:
            ValueError: It may be too long.
        """
        _check_length(self.most_m())

    def most_m(self) -> float:
        """Return a length that the curve does not exceed: as if it were everywhere as steep as at its steepest."""
        return self.n_periods * self.wavelength_m * hypot(1.0, self.steepest())

    def steepest(self) -> float:
        """Return the largest slope of the curve."""
        return self.amplitude_m * (2 * pi / self.wavelength_m)


class Straight(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="turn", tag="straight"):
    """A straight stretch."""

    length_m: Length


class Left(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="turn", tag="left"):
    """A counter-clockwise arc."""

    angle_deg: Arc


class Right(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="turn", tag="right"):
    """A clockwise arc."""

    angle_deg: Arc


class Arcs(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="arcs"):
    """A sequence of straight stretches and arcs of one radius, as in a Dubins path."""

    radius_m: Length
    segments: Annotated[tuple[Straight | Left | Right, ...], Meta(min_length=1, max_length=100)]

    def __post_init__(self) -> None:
        """Check the length of the curve.

        Raises:
            ValueError: It is too long.
        """
        _check_length(sum(map(self.length_of_m, self.segments)))

    def length_of_m(self, segment: Straight | Left | Right) -> float:
        """Return the length of one of the segments."""
        return (
            segment.length_m if isinstance(segment, Straight) else self.radius_m * float(np.radians(segment.angle_deg))
        )


Reference = Sine | Arcs


def _check_length(length_m: float) -> None:
    """Check that a curve is not longer than any room (`ValueError`)."""
    if not length_m <= MAX_LENGTH_M:
        raise ValueError(f"Expected a curve of at most {MAX_LENGTH_M:g} m, got {length_m:g} m")


def reference_curve(reference: Reference, begin: Pose2) -> Floats:
    """Return x, y and tangent direction, not wrapped, of the points of a curve that begins at `begin`, (n, 3)."""
    curve = _sine(reference) if isinstance(reference, Sine) else _arcs(reference)
    return np.column_stack([begin.apply(curve[:, :2]), curve[:, 2] + begin.yaw_rad])


def least_radius_m(reference: Reference) -> float:
    """Return the least radius of curvature of the curve; infinite for a straight one."""
    if isinstance(reference, Sine):
        return 1.0 / (reference.amplitude_m * (2 * pi / reference.wavelength_m) ** 2)
    straight = all(isinstance(segment, Straight) for segment in reference.segments)
    return np.inf if straight else reference.radius_m


def first_straight_m(reference: Reference) -> float:
    """Return the length of the straight stretch that the curve begins with, or 0."""
    first = reference.segments[0] if isinstance(reference, Arcs) else None
    return first.length_m if isinstance(first, Straight) else 0.0


def _sine(sine: Sine) -> Floats:
    per_m = 2 * pi / sine.wavelength_m
    length_m = sine.n_periods * sine.wavelength_m
    steepest = sine.steepest()
    x = np.linspace(0.0, length_m, ceil(length_m * np.hypot(1.0, steepest) / STEP_M) + 1)
    y = sine.amplitude_m * np.sin(per_m * x)
    turned = Pose2(x_m=0.0, y_m=0.0, yaw_rad=-atan(steepest))
    direction = np.arctan(steepest * np.cos(per_m * x)) + turned.yaw_rad
    return np.column_stack([turned.apply(np.column_stack([x, y])), direction])


def _arcs(arcs: Arcs) -> Floats:
    rows = [np.zeros((1, 3))]
    for segment in arcs.segments:
        x_m, y_m, direction = rows[-1][-1].tolist()
        length_m = arcs.length_of_m(segment)
        curvature = (
            0.0 if isinstance(segment, Straight) else (1.0 if isinstance(segment, Left) else -1.0) / arcs.radius_m
        )
        along = np.linspace(0.0, length_m, ceil(length_m / STEP_M) + 1)[1:]
        turned = curvature * along
        # sin(t)/t and (1 - cos(t))/t, which a straight stretch needs at t = 0.
        ahead = along * np.sinc(turned / pi)
        left = along * np.sinc(turned / (2 * pi)) * np.sin(turned / 2)
        c, s = np.cos(direction), np.sin(direction)
        rows.append(np.column_stack([x_m + c * ahead - s * left, y_m + s * ahead + c * left, direction + turned]))
    return np.concatenate(rows)
