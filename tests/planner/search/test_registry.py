"""Routes of every search by its name, and what no search can do."""

from typing import Any, get_args

import numpy as np
import pytest

from legpush.messages.planning import TrunkPathQuery
from legpush.plans.planner import PlanningInterruptedError
from legpush.scene.names import PlannerName, Steering
from legpush.scene.plan_settings import Anytime, Smoothing
from planner_proc.clearance.field import ClearanceField
from planner_proc.search.registry import routes, search_fault
from planner_proc.search.route import Route
from tests.planner import maps

PLANNERS: tuple[PlannerName, ...] = get_args(PlannerName)
TREES: tuple[PlannerName, ...] = ("rrt", "rrt_connect", "rrt_star", "informed_rrt_star")
"""These grow by edges no longer than the step."""
START, GOAL = (1.0, 1.0), (7.0, 5.0)


def run(planner: PlannerName, **changes: float) -> Route:
    """The first route through the maze."""
    asked = maps.query(maps.MAZE, START, GOAL, planner=planner, **({"max_iterations": 3000} | changes))
    return next(routes(asked, ClearanceField(maps.MAZE), lambda: False))


@pytest.mark.parametrize("planner", PLANNERS)
def test_a_route_leads_from_start_to_goal_along_free_edges(planner: PlannerName) -> None:
    route = run(planner)
    assert route.reached
    assert route.points_m[0].tolist() == list(START)
    assert route.points_m[-1].tolist() == list(GOAL)
    assert maps.true_clearance(maps.MAZE, maps.samples(route.points_m, 0.005)).min() >= maps.CLEARANCE_M - 1e-8


@pytest.mark.parametrize("planner", PLANNERS)
def test_every_edge_of_the_tree_is_free_and_where_it_grows_by_steps_no_longer_than_one(planner: PlannerName) -> None:
    route = run(planner)
    nodes = np.array(route.tree_points_m)
    edges = [(nodes[parent], node) for node, parent in zip(nodes, route.tree_parents, strict=True)]
    edges = [(a, b) for a, b in edges if (a != b).any()]
    assert len(edges) > 50
    for a, b in edges[::7]:
        assert maps.true_clearance(maps.MAZE, maps.samples(np.stack([a, b]), 0.01)).min() >= maps.CLEARANCE_M - 1e-8
    if planner not in TREES:
        return
    into_goal = [np.linalg.norm(b - a) for a, b in edges if b.tolist() == list(GOAL)]
    others = [np.linalg.norm(b - a) for a, b in edges if b.tolist() != list(GOAL)]
    assert max(others) <= 0.5 + 1e-9
    assert max(into_goal, default=0.0) <= (0.5 if planner == "rrt_star" else 0.25) + 1e-9


@pytest.mark.parametrize("planner", PLANNERS)
def test_the_tree_has_its_roots_at_the_ends_and_parents_before_children(planner: PlannerName) -> None:
    route = run(planner)
    roots = [node for node, parent in enumerate(route.tree_parents) if node == parent]
    assert [route.tree_points_m[root] for root in roots] == ([START, GOAL] if planner == "rrt_connect" else [START])
    assert all(parent < node or node in roots for node, parent in enumerate(route.tree_parents))


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_the_budget_is_kept_and_a_short_one_does_not_reach(planner: PlannerName, n: int) -> None:
    route = run(planner, max_iterations=n)
    assert route.n_iterations == n
    assert route.reached == (route.points_m[-1].tolist() == list(GOAL))
    assert not (route.reached and planner in TREES)
    assert route.points_m[0].tolist() == list(START)


@pytest.mark.parametrize(
    ("planner", "steering", "changes", "words"),
    [
        ("rrt_connect", "dubins", {}, "by dubins (rrt, rrt_star, informed_rrt_star, bit_star), got rrt_connect"),
        ("prm_star", "reeds_shepp", {}, "got prm_star"),
        ("rrt", "dubins", {"min_turning_radius_m": 0.0}, "min_turning_radius_m above 0"),
        ("rrt", "straight", {"smoothing": Smoothing(method="none")}, "spline or band for a turning radius"),
        ("prm_star", "straight", {"max_iterations": 10_000_000}, "at most 200000 iterations for prm_star"),
        (
            "prm_star",
            "straight",
            {"max_iterations": 150_000, "anytime": Anytime(n_improvements=51, improvement_iterations=1000)},
            "got 201000",
        ),
    ],
)
def test_what_a_search_cannot_do_is_refused_with_what_can(
    planner: PlannerName, steering: Steering, changes: dict[str, Any], words: str
) -> None:
    assert words in search_fault(steered(planner, steering, **changes))


@pytest.mark.parametrize("steering", ["straight", "dubins", "reeds_shepp"])
def test_rrt_can_be_steered_in_every_way(steering: Steering) -> None:
    assert search_fault(steered("rrt", steering)) == ""


def steered(planner: PlannerName, steering: Steering, **changes: Any) -> TrunkPathQuery:
    fields: dict[str, Any] = {"planner": planner, "steering": steering, "min_turning_radius_m": 0.5}
    return maps.query(maps.MAZE, START, GOAL, **(fields | changes))


@pytest.mark.parametrize("planner", PLANNERS)
def test_a_search_that_is_not_wanted_any_more_stops(planner: PlannerName) -> None:
    asked = maps.query(maps.MAZE, START, GOAL, planner=planner)
    with pytest.raises(PlanningInterruptedError):
        next(routes(asked, ClearanceField(maps.MAZE), lambda: True))
