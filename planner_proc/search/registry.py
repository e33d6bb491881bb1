"""Finds a search by its name, and refuses a steering that it cannot do."""

from collections.abc import Iterator
from typing import Final, get_args

from legpush.messages.planning import TrunkPathQuery
from legpush.plans.planner import Interrupted
from legpush.scene.names import PlannerName, Steering
from planner_proc.clearance.field import ClearanceField
from planner_proc.search.ompl_search import ompl_routes
from planner_proc.search.roadmap import MOST_SAMPLES, roadmap_routes
from planner_proc.search.route import Route

NOT_STEERED: Final[dict[PlannerName, tuple[Steering, ...]]] = {
    "rrt_connect": ("dubins",),
    "prm_star": ("dubins", "reeds_shepp"),
}
"""Steerings that a search cannot do: with forward motion only, a tree that grows from the goal would lead away from it,
and the places of the roadmap have no headings.
"""


def routes(query: TrunkPathQuery, field: ClearanceField, interrupted: Interrupted) -> Iterator[Route]:
    """Yield the first route and then, with `anytime`, one after each improvement, better or not.

    Equal queries get equal routes.

    Raises:
        PlanningInterruptedError: The routes are not wanted any more.
    """
    search = roadmap_routes if query.planner == "prm_star" else ompl_routes
    return search(query, field, interrupted)


def search_fault(query: TrunkPathQuery) -> str:
    """Why the query cannot be searched or steered as it asks; empty if it can."""
    if query.planner == "prm_star" and (n_samples := _n_iterations(query)) > MOST_SAMPLES:
        return f"Expected at most {MOST_SAMPLES} iterations for prm_star, which keeps all samples, got {n_samples}"
    if query.steering != "straight" and query.min_turning_radius_m == 0.0:
        return f"Expected min_turning_radius_m above 0 m for the steering {query.steering}, got 0"
    if query.steering in NOT_STEERED.get(query.planner, ()):
        others = ", ".join(name for name in get_args(PlannerName) if query.steering not in NOT_STEERED.get(name, ()))
        return f"Expected a planner that can be steered by {query.steering} ({others}), got {query.planner}"
    if query.steering == "straight" and query.min_turning_radius_m > 0.0 and query.smoothing.method == "none":
        return "Expected the smoothing spline or band for a turning radius between straight lines, got none"
    return ""


def _n_iterations(query: TrunkPathQuery) -> int:
    """Number of iterations, those of all improvements included."""
    anytime = query.anytime
    return query.max_iterations + (
        anytime.n_improvements * anytime.improvement_iterations if anytime is not None else 0
    )
