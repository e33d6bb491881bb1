"""The search for a path of the box: direct ways, and two trees that meet."""

from itertools import pairwise

import pytest
from msgspec.structs import replace

from legpush.messages.planning import BoxPathQuery
from legpush.plans.planner import PlanningInterruptedError
from legpush.scene.scenario import Rectangle, Room
from planner_proc.box.pushes import Pushes
from planner_proc.box.search import Found, search
from planner_proc.clearance.field import ClearanceField
from tests.planner.boxes import OPEN, query
from tests.planner.maps import pose

WALL = Room(size_m=(8.0, 8.0), obstacles=(Rectangle(x_min_m=3.9, x_max_m=4.1, y_min_m=1.5, y_max_m=6.5),))
AROUND = query(WALL, pose(2.5, 4.0), pose(5.5, 4.0), max_iterations=400)


def pushes_for(asked: BoxPathQuery) -> Pushes:
    return Pushes(asked, ClearanceField(asked.grid))


def run(asked: BoxPathQuery) -> Found:
    return search(asked, pushes_for(asked), lambda: False)


def test_in_the_open_the_cheapest_direct_way_needs_no_tree() -> None:
    found = run(query(OPEN, pose(4.0, 4.0), pose(6.0, 4.0)))

    assert found.n_iterations == 0
    assert sum(stage.length_m for stage in found.way) == pytest.approx(2.0)
    assert (found.tree_points_m, found.tree_parents) == (((4.0, 4.0), (6.0, 4.0)), (0, 0))


def test_around_a_wall_two_trees_find_a_free_way_and_equal_queries_get_equal_ones() -> None:
    found = run(AROUND)

    assert 0 < found.n_iterations <= 400
    assert found.way[0].begin == AROUND.start
    assert found.way[-1].end.xy() == pytest.approx(AROUND.goal.xy(), abs=AROUND.position_tolerance_m)
    assert all(a.end == b.begin for a, b in pairwise(found.way))
    assert pushes_for(AROUND).free(found.way, None)
    assert found.tree_points_m[0] == (2.5, 4.0)
    assert all(parent < node or parent == node == 0 for node, parent in enumerate(found.tree_parents))
    assert run(AROUND) == found
    assert run(replace(AROUND, seed=2)) != found


def test_without_a_way_the_whole_budget_is_used() -> None:
    cut = Room(size_m=(8.0, 8.0), obstacles=(Rectangle(x_min_m=3.9, x_max_m=4.1, y_min_m=0.0, y_max_m=8.0),))
    found = run(query(cut, pose(2.5, 4.0), pose(5.5, 4.0), max_iterations=30))

    assert (found.way, found.n_iterations) == ((), 30)


def test_a_search_that_is_not_wanted_any_more_stops_at_once() -> None:
    n_asked = 0

    def interrupted() -> bool:
        nonlocal n_asked
        n_asked += 1
        return n_asked > 5

    with pytest.raises(PlanningInterruptedError):
        search(AROUND, pushes_for(AROUND), interrupted)
    assert n_asked == 6
