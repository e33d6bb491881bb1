"""What the paper pays (Eqs. 16 to 18), and the bonuses of its code: how far tracked corners are from their goals."""

from math import sqrt
from typing import Annotated, Literal

import numpy as np
from msgspec import Meta

from agent_proc.frames.push_view import PushView
from agent_proc.task.term import PushStep, RewardTerm
from legpush.arrays import Floats
from legpush.bounds import Length

Corners = Annotated[tuple[Literal[1, 2], ...], Meta(min_length=1, max_length=2)]


class CornerDistance(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Distances of both tracked corners from their goals on the floor, m, added (Eq. 17 without its weight)."""

    def value(self, step: PushStep) -> float:
        """`sqrt(e1) + sqrt(e2)`, with `e_i` the squared planar error of corner i."""
        e1, e2 = (corner_errors_m(step.after) ** 2).sum(axis=1).tolist()
        return sqrt(e1) + sqrt(e2)


class AngleError(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Angle between the box and its goal, rad, without sign (Eq. 18 without its weight)."""

    def value(self, step: PushStep) -> float:
        """`sqrt(e_angle)`, with `e_angle` the squared, wrapped error of the yaw."""
        return sqrt(step.after.error.angle_rad**2)


class CornersWithin(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """1 if tracked corners are near their goals, as the published code pays its bonuses; else 0."""

    corners: Corners = (1, 2)
    """Corners that must all be near: 1 is front left, 2 front right."""
    within_m: Length = 0.1
    """How near, less than this."""
    along: Literal["floor", "x"] = "floor"
    """The planar distance, or its part along the x axis of the world alone."""
    at_end: bool = False
    """Whether it counts in the last step of an episode alone."""

    def value(self, step: PushStep) -> float:
        """1 or 0."""
        if self.at_end and step.ending in (None, "max_steps"):
            return 0.0
        errors_m = corner_errors_m(step.after)[[corner - 1 for corner in self.corners]]
        distances_m = np.abs(errors_m[:, 0]) if self.along == "x" else np.linalg.norm(errors_m, axis=1)
        return 1.0 if (distances_m < self.within_m).all() else 0.0


def corner_errors_m(view: PushView) -> Floats:
    """From the goals of the tracked corners to the corners, on the floor, world frame, (2, 2)."""
    errors: Floats = view.corners_w_m[:, :2] - view.goal_corners_w_m
    return errors
