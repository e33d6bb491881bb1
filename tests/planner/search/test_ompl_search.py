"""Trees of OMPL, looked at from outside."""

import gc
import weakref

import numpy as np
import pytest

from legpush.messages.planning import TrunkPathQuery
from legpush.scene.names import PlannerName
from legpush.scene.plan_settings import Anytime
from planner_proc.clearance.field import ClearanceField
from planner_proc.search.ompl_search import ompl_routes
from planner_proc.search.route import Route
from tests.planner import maps

START, GOAL = (1.0, 1.0), (7.0, 5.0)


def search(query: TrunkPathQuery, field: ClearanceField) -> Route:
    """The first route."""
    return next(ompl_routes(query, field, lambda: False))


def run(planner: PlannerName, **changes: float) -> Route:
    """The first route through the maze."""
    asked = maps.query(maps.MAZE, START, GOAL, planner=planner, **({"max_iterations": 3000} | changes))
    return search(asked, ClearanceField(maps.MAZE))


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
    field = ClearanceField(maps.MAZE)
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


def test_rrt_star_spends_its_budget_on_shorter_paths() -> None:
    def length_m(route: Route) -> float:
        return float(np.linalg.norm(np.diff(route.points_m, axis=0), axis=1).sum())

    few, many = run("rrt_star", max_iterations=1000), run("rrt_star", max_iterations=4000)
    assert (few.n_iterations, many.n_iterations) == (1000, 4000)
    assert length_m(many) < length_m(few) < length_m(run("rrt"))


@pytest.mark.parametrize("planner", ["rrt", "rrt_star"])
def test_with_anytime_each_improvement_uses_its_own_iterations(planner: PlannerName) -> None:
    anytime = Anytime(n_improvements=2, improvement_iterations=300)
    asked = maps.query(maps.MAZE, START, GOAL, planner=planner, max_iterations=3000, anytime=anytime)
    found = list(ompl_routes(asked, ClearanceField(maps.MAZE), lambda: False))

    assert len(found) == 3
    first, second, third = (route.n_iterations for route in found)
    if planner == "rrt_star":
        assert (second - first, third - second) == (300, 300)
        assert first % 100 == 0, "it looks for a path every hundred iterations"
    else:
        assert max(second, third) <= 300
        assert len({route.points_m.tobytes() for route in found}) == 3


@pytest.mark.parametrize("planner", ["bit_star", "rrt_star", "rrt_connect"])
def test_a_planner_that_serves_for_days_keeps_no_maps(planner: PlannerName) -> None:
    fields: list[weakref.ref[ClearanceField]] = []
    for seed in range(3):
        field = ClearanceField(maps.MAZE)
        fields.append(weakref.ref(field))
        search(maps.query(maps.MAZE, START, GOAL, planner=planner, seed=seed, max_iterations=500), field)
        del field
    gc.collect()
    assert [field() for field in fields] == [None] * 3
