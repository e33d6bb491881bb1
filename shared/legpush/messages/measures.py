"""What is measured of a motion at every physics step, and how the measures of several motions are put together."""

from collections.abc import Callable, Iterable
from typing import Annotated, Final, TypeVar

import numpy as np
from msgspec import Meta, Struct

from legpush.bounds import Count, Reading
from legpush.fields import Name
from legpush.scene.conventions import JOINTS, LEG_JOINTS

MAX_PAIRS: Final = 64
"""Most pairs of parts in the measures of one motion; those that touch in the most steps are kept."""
MAX_LANDINGS: Final = 64
"""Most landings in the measures of one motion, of which a gait cycle has four; the fastest are kept."""
TORQUE_BINS: Final = 100
"""Torques are counted in hundredths of the largest torque of their joint."""

T = TypeVar("T")
JointReadings = Annotated[tuple[Reading, ...], Meta(min_length=len(LEG_JOINTS), max_length=len(LEG_JOINTS))]
"""One number for each joint: legs in the order FL, FR, RL, RR; of each leg hip-x, hip-y, knee."""
JointCounts = Annotated[tuple[Count, ...], Meta(min_length=len(LEG_JOINTS), max_length=len(LEG_JOINTS))]
TorqueCounts = Annotated[tuple[Count, ...], Meta(min_length=TORQUE_BINS, max_length=TORQUE_BINS)]


class UnexpectedContact(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Two parts that touched though no plan asked for it. Plans ask for feet on the floor, and a push for foot and
    lower leg of the pushing leg on the box; and the box stands on the floor."""

    first: Name
    """Name of a geom of the model, such as `FL_lower`; the two names are in alphabetical order."""
    second: Name
    n_steps: Count
    """Number of physics steps of 2 ms in which they touched."""
    max_force_n: Reading
    """Largest force of one contact between them."""


class Measures(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Measurements over all physics steps of 2 ms of a motion. A foot is loaded from the step on in which the floor
    carries it with 4.8 % of the robot's weight, 15 N, to the one in which that falls below 1.6 %, 5 N, also from one
    motion to the next. The support polygon is the convex hull of the centres of the loaded feet, and margins are
    distances to its border, positive inside."""

    n_steps: Count
    """Number of physics steps."""
    n_footsteps: Count
    """Number of steps of single feet."""
    max_torques_n_m: JointReadings
    """Largest magnitude of the torque of each servo."""
    max_speeds_rad_s: JointReadings
    """Largest speed of each joint, either way."""
    max_powers_w: JointReadings
    """Largest magnitude of the product of torque and speed."""
    n_at_torque_limit: JointCounts
    """Number of steps in which the torque of the servo was at its limit, which depends on angle and speed."""
    least_to_limits_rad: JointReadings
    """Least distance of each joint from the nearer end of its range; negative beyond it."""
    torque_counts: Annotated[tuple[TorqueCounts, ...], Meta(min_length=len(JOINTS), max_length=len(JOINTS))]
    """How often the torque of a hip-x, a hip-y and a knee joint had which magnitude, in hundredths of the largest
    torque of the joint, over all legs and steps."""
    positive_work_j: Reading
    """Mechanical work of all servos while their power was positive; none is gained back."""
    min_support_margin_m: Reading
    """Least margin of the CoM's projection on the floor, along gravity."""
    n_outside_support: Count
    """Number of steps in which that margin was negative."""
    min_zmp_margin_m: Reading
    """Least margin of the zero-moment point, the centre of pressure of the feet."""
    min_capture_margin_m: Reading
    """Least margin of the capture point (divergent component of motion): the CoM's projection plus its velocity divided
    by sqrt(g / h), with the height h of the standing robot's CoM."""
    max_push_moment_n_m: Reading | None
    """Largest horizontal part of the moment of all forces on the feet about the CoM, from floor and box, while the box
    pressed on a foot with at least 1 N; nil if it never did. Eq. 9 sets the moment to zero. It is the rate of change of
    the angular momentum about the CoM, so that moving legs and a swaying trunk make it differ from zero."""
    n_touchdowns: Count
    """How often the vertical force of the floor on a foot rose above 1 N."""
    n_loadings: Count
    """How often a foot became loaded, with the two thresholds above."""
    landing_speeds_m_s: Annotated[tuple[Reading, ...], Meta(max_length=MAX_LANDINGS)]
    """Downward speed of a foot in the last step before each touchdown that ended at least 60 ms in the air."""
    max_penetration_m: Reading
    """How deep a foot was in the floor at most."""
    n_unexpected_steps: Count
    """Number of steps with a contact that no plan asked for."""
    unexpected: Annotated[tuple[UnexpectedContact, ...], Meta(max_length=MAX_PAIRS)]


def merged(measures: Iterable[Measures]) -> Measures | None:
    """Put the measures of several motions together as if they had been one; None if there are none.

    The result may have more landings and pairs than a message.
    """
    parts = list(measures)
    if not parts:
        return None

    def each(name: str, of: Callable[[Iterable[T]], T]) -> tuple[T, ...]:
        return tuple(of(values) for values in zip(*(getattr(part, name) for part in parts), strict=True))

    moments = [part.max_push_moment_n_m for part in parts if part.max_push_moment_n_m is not None]
    counts = np.array([part.torque_counts for part in parts]).sum(axis=0)
    return Measures(
        n_steps=sum(part.n_steps for part in parts),
        n_footsteps=sum(part.n_footsteps for part in parts),
        max_torques_n_m=each("max_torques_n_m", max),
        max_speeds_rad_s=each("max_speeds_rad_s", max),
        max_powers_w=each("max_powers_w", max),
        n_at_torque_limit=each("n_at_torque_limit", sum),
        least_to_limits_rad=each("least_to_limits_rad", min),
        torque_counts=tuple(map(tuple, counts.tolist())),
        positive_work_j=sum(part.positive_work_j for part in parts),
        min_support_margin_m=min(part.min_support_margin_m for part in parts),
        n_outside_support=sum(part.n_outside_support for part in parts),
        min_zmp_margin_m=min(part.min_zmp_margin_m for part in parts),
        min_capture_margin_m=min(part.min_capture_margin_m for part in parts),
        max_push_moment_n_m=max(moments, default=None),
        n_touchdowns=sum(part.n_touchdowns for part in parts),
        n_loadings=sum(part.n_loadings for part in parts),
        landing_speeds_m_s=tuple(speed for part in parts for speed in part.landing_speeds_m_s),
        max_penetration_m=max(part.max_penetration_m for part in parts),
        n_unexpected_steps=sum(part.n_unexpected_steps for part in parts),
        unexpected=_merged_contacts(contact for part in parts for contact in part.unexpected),
    )


def torque_quantiles(measures: Measures, share: float) -> tuple[float, ...]:
    """Torques that a share of all torques of hip-x, hip-y and knee joints is below, as shares of their largest ones.

    Each is the upper end of a bin, so at most a hundredth too large.
    """
    counts = np.array(measures.torque_counts)
    below = counts.cumsum(axis=1) >= share * counts.sum(axis=1, keepdims=True)
    quantiles: list[float] = ((below.argmax(axis=1) + 1) / TORQUE_BINS).tolist()
    return tuple(quantiles)


def _merged_contacts(contacts: Iterable[UnexpectedContact]) -> tuple[UnexpectedContact, ...]:
    by_pair: dict[tuple[str, str], UnexpectedContact] = {}
    for contact in contacts:
        pair = contact.first, contact.second
        before = by_pair.get(pair)
        by_pair[pair] = UnexpectedContact(
            first=contact.first,
            second=contact.second,
            n_steps=contact.n_steps + (before.n_steps if before else 0),
            max_force_n=max(contact.max_force_n, before.max_force_n if before else 0.0),
        )
    return tuple(sorted(by_pair.values(), key=lambda each: (-each.n_steps, each.first, each.second)))
