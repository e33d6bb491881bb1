"""Settings of paths of the trunk: their search, steering and smoothing, and which of them fit each other."""

from typing import Final, Literal, Protocol, get_args

from msgspec import Struct

from legpush.bounds import (
    Deviation,
    Distance,
    Improvements,
    Iterations,
    Length,
    Margin,
    ShortIterations,
    Unit,
    Waypoints,
)
from legpush.scene.names import PlannerName, Steering

NOT_STEERED: Final[dict[PlannerName, tuple[Steering, ...]]] = {
    "rrt_connect": ("dubins",),
    "prm_star": ("dubins", "reeds_shepp"),
}
"""Steerings that a search cannot do: with forward motion only, a tree that grows from the goal would lead away from it,
and the places of the roadmap have no headings.
"""


class Smoothing(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the path of the search is smoothed. The smoothed path always keeps the clearance."""

    method: Literal["none", "spline", "band"] = "band"
    """`none`: keep the path of the search, with turns on the spot. `spline`: the paper's cubic spline through the
    corners of the path, pulled back to the path where it would collide. `band`: a spline along an elastic band, which
    keeps away from obstacles."""
    shorten: bool = True
    """Whether to cut off detours first, where a straight line is free."""
    comfort_m: Margin = 0.25
    """Distance that a `band` keeps beyond the required clearance if there is room; it widens turns around corners."""
    max_deviation_m: Deviation | None = None
    """Largest distance from the path of the search, before it was shortened; without it, any distance is allowed."""
    max_waypoints: Waypoints = 20_000
    """Most waypoints of a smooth path; on a long path they lie farther apart than 0.05 m."""


class Anytime(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Asks for better paths after the first one, each after a fixed number of iterations so that runs repeat."""

    n_improvements: Improvements = 10
    """How many better paths to look for."""
    improvement_iterations: ShortIterations = 500
    """Iterations of the search for each of them."""


class PlanSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Settings of the queries for paths of the trunk."""

    planner: PlannerName = "rrt_connect"
    steering: Steering = "straight"
    """How the path connects poses. `straight`: straight lines and turns on the spot. `dubins`: arcs and lines, forward
    only. `reeds_shepp`: arcs and lines, backward too."""
    min_turning_radius_m: Distance = 0.0
    """Least turning radius; 0 allows any. With `straight`, it holds for the smoothed path between start and goal."""
    max_iterations: Iterations = 20_000
    """Budget of the search."""
    goal_bias: Unit = 0.05
    """Probability that a sample is the goal."""
    step_m: Length = 0.5
    """Longest edge of the tree."""
    goal_region_m: Length = 0.25
    """Radius of the goal region of Algorithm 1."""
    margin_m: Margin = 0.1
    """Clearance to keep beyond the circle through the robot's feet."""
    body_margin_m: Margin = 0.05
    """Clearance that the floor which the robot covers keeps, turns on the spot included."""
    smoothing: Smoothing = Smoothing()
    anytime: Anytime | None = None
    """With it, the robot starts to walk on the first path, and may switch to a better one between gait cycles."""


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
