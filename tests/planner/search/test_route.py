"""The search trees, looked at from outside."""

from typing import get_args

import numpy as np
import pytest

from legpush.messages.planning import TrunkPathQuery
from legpush.scene.names import PlannerName
from planner_proc.clearance.field import ClearanceField
from planner_proc.search.registry import routes
from planner_proc.search.route import Route
from planner_proc.search_tree import thin
from tests.planner import maps

PLANNERS: tuple[PlannerName, ...] = get_args(PlannerName)
TREES: tuple[PlannerName, ...] = ("rrt", "rrt_connect", "rrt_star", "informed_rrt_star")
"""These grow by edges no longer than the step."""
MAZE = maps.room((0.0, 5.5, 1.9, 2.1), (2.5, 8.0, 3.9, 4.1))
START, GOAL = (1.0, 1.0), (7.0, 5.0)


def search(query: TrunkPathQuery, field: ClearanceField) -> Route:
    """The first route."""
    return next(routes(query, field, lambda: False))


def run(planner: PlannerName, **changes: float) -> Route:
    asked = maps.query(MAZE, START, GOAL, planner=planner, **({"max_iterations": 3000} | changes))
    return search(asked, ClearanceField(MAZE))


@pytest.mark.parametrize("planner", PLANNERS)
def test_a_route_leads_from_start_to_goal_along_free_edges(planner: PlannerName) -> None:
    route = run(planner)
    assert route.reached
    assert route.points_m[0].tolist() == list(START)
    assert route.points_m[-1].tolist() == list(GOAL)
    assert maps.true_clearance(MAZE, maps.samples(route.points_m, 0.005)).min() >= maps.CLEARANCE_M - 1e-8


@pytest.mark.parametrize("planner", PLANNERS)
def test_every_edge_of_the_tree_is_free_and_where_it_grows_by_steps_no_longer_than_one(planner: PlannerName) -> None:
    route = run(planner)
    nodes = np.array(route.tree_points_m)
    edges = [(nodes[parent], node) for node, parent in zip(nodes, route.tree_parents, strict=True)]
    edges = [(a, b) for a, b in edges if (a != b).any()]
    assert len(edges) > 50
    for a, b in edges[::7]:
        assert maps.true_clearance(MAZE, maps.samples(np.stack([a, b]), 0.01)).min() >= maps.CLEARANCE_M - 1e-8
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


@pytest.mark.parametrize("planner", ["rrt", "rrt_star"])
def test_the_path_follows_the_parents_from_the_goal_to_the_start(planner: PlannerName) -> None:
    route = run(planner)
    node = len(route.tree_points_m) - 1 if planner == "rrt" else route.tree_points_m.index(tuple(route.points_m[-1]))
    back = [route.tree_points_m[node]]
    while route.tree_parents[node] != node:
        node = route.tree_parents[node]
        back.append(route.tree_points_m[node])
    assert back[::-1] == [tuple(point) for point in route.points_m.tolist()]


@pytest.mark.parametrize("seed", range(10))
def test_rrt_stops_at_the_first_node_in_the_goal_region_that_sees_the_goal(seed: int) -> None:
    route = run("rrt", seed=seed, goal_region_m=0.6)
    assert route.reached
    field = ClearanceField(MAZE)
    connected = [
        node
        for node in route.tree_points_m
        if 0.0 < np.linalg.norm(np.subtract(node, GOAL)) < 0.6 and field.segment_is_free(node, GOAL, maps.CLEARANCE_M)
    ]
    assert connected in ([tuple(route.points_m[-2])], [])
    assert np.linalg.norm(route.points_m[-2] - GOAL) <= 0.6


def test_a_node_in_the_goal_region_behind_a_wall_does_not_count() -> None:
    grid = maps.room((0.0, 7.0, 2.9, 3.0))
    asked = maps.query(grid, (1.0, 2.0), (1.0, 3.9), planner="rrt", clearance_m=0.3, goal_region_m=2.5)
    field = ClearanceField(grid)
    for seed in range(5):
        route = search(maps.query(grid, (1.0, 2.0), (1.0, 3.9), planner="rrt", clearance_m=0.3, seed=seed), field)
        assert route.reached
        assert route.points_m[:, 0].max() > 7.0
    assert search(asked, field).points_m[:, 0].max() > 7.0


def test_full_goal_bias_goes_straight_and_none_still_arrives() -> None:
    grid = maps.room()
    field = ClearanceField(grid)
    straight = search(maps.query(grid, START, GOAL, planner="rrt", goal_bias=1.0), field)
    assert np.linalg.norm(np.diff(straight.points_m, axis=0), axis=1).sum() == pytest.approx(np.hypot(6.0, 4.0))
    assert search(maps.query(grid, START, GOAL, planner="rrt", goal_bias=0.0), field).reached


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_the_budget_is_kept_and_a_short_one_does_not_reach(planner: PlannerName, n: int) -> None:
    route = run(planner, max_iterations=n)
    assert route.n_iterations == n
    assert route.reached == (route.points_m[-1].tolist() == list(GOAL))
    assert not (route.reached and planner in TREES)
    assert route.points_m[0].tolist() == list(START)


def test_rrt_star_spends_its_budget_on_shorter_paths() -> None:
    def length_m(route: Route) -> float:
        return float(np.linalg.norm(np.diff(route.points_m, axis=0), axis=1).sum())

    few, many = run("rrt_star", max_iterations=1000), run("rrt_star", max_iterations=4000)
    assert (few.n_iterations, many.n_iterations) == (1000, 4000)
    assert length_m(many) < length_m(few) < length_m(run("rrt"))


def test_a_tree_that_is_too_large_keeps_the_path_and_its_first_nodes() -> None:
    nodes = [(float(i), 0.0) for i in range(100)]
    parents = [0, *range(50), *[3] * 48, 10]
    kept, kept_parents = thin(nodes, parents, 30)
    assert len(kept) == len(kept_parents) == 18 + 1
    assert kept[:18] == nodes[:18]
    node, branch = len(kept) - 1, []
    while kept_parents[node] != node:
        branch.append(kept[node])
        node = kept_parents[node]
    assert branch == [nodes[99], *(nodes[i] for i in range(10, 0, -1))]
    assert thin(nodes, parents, 100) == (nodes, parents)
    assert thin(nodes, parents, 5) == (nodes[:5], parents[:5])
