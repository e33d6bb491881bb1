"""Finds a search by its name, and refuses a steering that it cannot do."""

from collections.abc import Iterator

from legpush.messages.planning import TrunkPathQuery
from legpush.plans.planner import Interrupted
from legpush.scene.plan_settings import steering_fault
from planner_proc.clearance.field import ClearanceField
from planner_proc.search.ompl_search import ompl_routes
from planner_proc.search.roadmap import MOST_SAMPLES, roadmap_routes
from planner_proc.search.route import Route


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
    return steering_fault(query)


def _n_iterations(query: TrunkPathQuery) -> int:
    """Number of iterations, those of all improvements included."""
    anytime = query.anytime
    return query.max_iterations + (
        anytime.n_improvements * anytime.improvement_iterations if anytime is not None else 0
    )
