"""Which steering needs a turning radius, and which searches of the built-in planner it works with."""

from typing import Final, Protocol, get_args

from legpush.scene.names import PlannerName, Steering
from legpush.scene.scenario import Smoothing

NOT_STEERED: Final[dict[PlannerName, tuple[Steering, ...]]] = {
    "rrt_connect": ("dubins",),
    "prm_star": ("dubins", "reeds_shepp"),
}
"""Steerings that a search cannot do: with forward motion only, a tree that grows from the goal would lead away from it,
and the places of the roadmap have no headings.
"""


class Steered(Protocol):
    """The settings of a search that a steering has to fit: those of a scenario, or of a query."""

    @property
    def planner(self) -> PlannerName:
        """The search."""

    @property
    def steering(self) -> Steering:
        """How the path connects poses."""

    @property
    def min_turning_radius_m(self) -> float:
        """Least turning radius; 0 allows any."""

    @property
    def smoothing(self) -> Smoothing:
        """How the path is smoothed."""


def radius_fault(asked: Steered) -> str:
    """Return why the steering cannot do without a turning radius; empty if it has one or needs none."""
    if asked.steering != "straight" and asked.min_turning_radius_m == 0.0:
        return f"Expected min_turning_radius_m above 0 m for the steering {asked.steering}, got 0"
    return ""


def steering_fault(asked: Steered) -> str:
    """Return why the built-in planner cannot steer as it is asked; empty if it can."""
    if fault := radius_fault(asked):
        return fault
    if asked.steering in NOT_STEERED.get(asked.planner, ()):
        others = ", ".join(name for name in get_args(PlannerName) if asked.steering not in NOT_STEERED.get(name, ()))
        return f"Expected a planner that can be steered by {asked.steering} ({others}), got {asked.planner}"
    if asked.steering == "straight" and asked.min_turning_radius_m > 0.0 and asked.smoothing.method == "none":
        return "Expected the smoothing spline or band for a turning radius between straight lines, got none"
    return ""
