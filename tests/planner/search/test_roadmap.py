"""The roadmap: shortest ways through free places."""

import numpy as np

from legpush.arrays import Floats
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.plan_settings import Anytime
from planner_proc.clearance.field import ClearanceField
from planner_proc.search.roadmap import roadmap_routes
from planner_proc.search.route import Route
from tests.planner import maps


def found(grid: OccupancyGrid, goal: tuple[float, float], **changes: object) -> list[Route]:
    asked = maps.query(grid, (1.0, 1.0), goal, planner="prm_star", **({"max_iterations": 1000} | changes))
    return list(roadmap_routes(asked, ClearanceField(grid), lambda: False))


def length_m(points_m: Floats) -> float:
    return float(np.hypot(*np.diff(points_m, axis=0).T).sum())


def test_in_the_open_the_way_is_nearly_straight_and_shorter_with_more_samples() -> None:
    lengths_m = [length_m(found(maps.room(), (7.0, 5.0), max_iterations=n)[0].points_m) for n in (30, 3000)]

    assert np.hypot(6.0, 4.0) <= lengths_m[1] < 1.02 * np.hypot(6.0, 4.0)
    assert lengths_m[1] < lengths_m[0]


def test_a_goal_that_is_cut_off_gets_the_way_to_the_nearest_place_on_this_side() -> None:
    (route,) = found(maps.room((0.0, 8.0, 3.0, 3.2)), (1.0, 5.0))

    assert not route.reached
    assert route.points_m[0].tolist() == [1.0, 1.0]
    assert 2.3 < route.points_m[-1, 1] <= 3.0 - maps.CLEARANCE_M
    assert abs(route.points_m[-1, 0] - 1.0) < 0.5


def test_equal_seeds_give_equal_routes_and_others_give_others() -> None:
    first, again, other = (found(maps.MAZE, (7.0, 5.0), seed=seed)[0] for seed in (3, 3, 4))

    assert first.points_m.tolist() == again.points_m.tolist()
    assert (first.tree_points_m, first.tree_parents) == (again.tree_points_m, again.tree_parents)
    assert first.points_m.tolist() != other.points_m.tolist()


def test_the_first_route_comes_early_and_each_improvement_draws_more_samples() -> None:
    anytime = Anytime(n_improvements=3, improvement_iterations=400)
    revisions = found(maps.MAZE, (7.0, 5.0), max_iterations=5000, anytime=anytime)

    assert [route.reached for route in revisions] == [True] * 4
    assert revisions[0].n_iterations < 1000
    n = [route.n_iterations for route in revisions]
    assert np.diff(n).tolist() == [400] * 3
    assert length_m(revisions[-1].points_m) < length_m(revisions[0].points_m)
