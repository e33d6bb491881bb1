"""Better paths after the first one, and searches that are interrupted."""

from typing import Any, get_args

import pytest
from msgspec.structs import replace

from legpush.messages.planning import PlanQuery
from legpush.plans.planner import PlanningInterruptedError
from legpush.scene.names import PlannerName
from legpush.scene.scenario import Anytime, Rectangle
from planner_proc.planning import make_plan, make_plans
from tests.planner import maps
from tests.planner.boxes import OPEN
from tests.planner.boxes import query as box_query

PLANNERS: tuple[PlannerName, ...] = get_args(PlannerName)


def asked(planner: PlannerName, **changes: Any) -> PlanQuery:
    anytime = Anytime(n_improvements=4, improvement_iterations=400)
    return maps.query(maps.MAZE, (1.0, 1.0), (7.0, 5.0), planner=planner, **({"anytime": anytime} | changes))


@pytest.mark.parametrize("planner", PLANNERS)
def test_each_revision_is_at_least_as_good_and_equal_queries_get_equal_ones(planner: PlannerName) -> None:
    revisions = list(make_plans(asked(planner), lambda: False))
    assert len(revisions) == 5
    assert {plan.status for plan in revisions} == {"exact"}
    lengths_m = [plan.length_m for plan in revisions]
    assert lengths_m == sorted(lengths_m, reverse=True)
    for plan in revisions:
        path = maps.samples(maps.positions(plan), 0.02)
        assert maps.true_clearance(maps.MAZE, path).min() >= maps.CLEARANCE_M - 1e-7
    assert list(make_plans(asked(planner), lambda: False)) == revisions


@pytest.mark.parametrize("planner", ["rrt_star", "informed_rrt_star", "bit_star", "prm_star"])
def test_the_first_answer_does_not_wait_for_the_whole_budget(planner: PlannerName) -> None:
    first = next(make_plans(asked(planner), lambda: False))
    whole = make_plan(asked(planner, anytime=None, max_iterations=3000))
    assert first.n_iterations < whole.n_iterations == 3000


@pytest.mark.parametrize("planner", ["rrt", "rrt_connect"])
def test_planners_that_find_another_path_each_time_find_a_better_one_sooner_or_later(planner: PlannerName) -> None:
    changes = {"smoothing": maps.NOT_SMOOTHED, "anytime": Anytime(n_improvements=8, improvement_iterations=3000)}
    revisions = list(make_plans(asked(planner, **changes), lambda: False))
    assert len({plan.length_m for plan in revisions}) > 1


def test_more_samples_than_a_roadmap_can_hold_are_refused() -> None:
    plan = make_plan(asked("prm_star", anytime=None, max_iterations=10_000_000))
    assert plan.status == "invalid"
    assert "at most 200000 iterations for prm_star" in plan.reason


def test_improvements_get_shorter_where_there_is_something_to_gain() -> None:
    changes = {"smoothing": maps.NOT_SMOOTHED}
    revisions = list(make_plans(asked("rrt_star", **changes), lambda: False))
    assert revisions[-1].length_m < revisions[0].length_m - 0.1


@pytest.mark.parametrize("planner", PLANNERS)
def test_a_search_stops_when_it_is_interrupted(planner: PlannerName) -> None:
    n_asked = 0

    def interrupted() -> bool:
        nonlocal n_asked
        n_asked += 1
        return n_asked > 5

    cut = maps.room((3.9, 4.1, 0.0, 6.0))
    query = maps.query(cut, (1.0, 3.0), (7.0, 3.0), planner=planner, anytime=Anytime(n_improvements=100))
    with pytest.raises(PlanningInterruptedError):
        list(make_plans(query, interrupted))
    assert n_asked < 20


def test_a_search_for_a_path_of_the_box_stops_too() -> None:
    wall = Rectangle(x_min_m=3.9, x_max_m=4.1, y_min_m=0.0, y_max_m=8.0)
    query = box_query(replace(OPEN, obstacles=(wall,)), maps.pose(2.5, 4.0), maps.pose(5.5, 4.0))
    with pytest.raises(PlanningInterruptedError):
        list(make_plans(query, lambda: True))
