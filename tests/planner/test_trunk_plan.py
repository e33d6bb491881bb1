"""Paths of the trunk, judged from outside: by a measure of clearance that shares nothing with the planner."""

import re
from math import nan, pi
from typing import Any, get_args

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import wrap_angle
from legpush.messages.codec import decode, encode
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.names import PlannerName
from legpush.scene.plan_settings import Anytime, Smoothing
from planner_proc.clearance.field import ClearanceField
from planner_proc.trunk_plan import make_trunk_plans
from tests.planner import maps

PLANNERS: tuple[PlannerName, ...] = ("rrt", "rrt_connect", "rrt_star")
ALL_PLANNERS: tuple[PlannerName, ...] = get_args(PlannerName)
QUERY = maps.query(maps.MAZE, (1.0, 1.0, -1.0), (7.0, 5.0, 2.0))
U_TRAP = maps.room((4.5, 4.9, 1.5, 4.5), (2.5, 4.9, 1.5, 1.9), (2.5, 4.9, 4.1, 4.5))


def plans_for(query: TrunkPathQuery) -> list[Plan]:
    """All revisions."""
    return list(make_trunk_plans(query, ClearanceField(query.grid), lambda: False))


def make_plan(query: TrunkPathQuery) -> Plan:
    """The first plan."""
    return next(make_trunk_plans(query, ClearanceField(query.grid), lambda: False))


def check(query: TrunkPathQuery, plan: Plan) -> None:
    """What must hold of every plan with a path."""
    path = maps.positions(plan)
    least_m = maps.true_clearance(query.grid, maps.samples(path, 0.01)).min()
    assert least_m >= query.clearance_m - 1e-7
    assert least_m - 0.01 <= plan.min_clearance_m <= least_m + 1e-9
    assert plan.length_m == pytest.approx(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    assert plan.waypoints[0] == query.start
    assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() <= 0.05 + 1e-9
    assert path[0].tolist() == path[1].tolist()
    if plan.status == "exact":
        assert plan.waypoints[-1] == query.goal
        assert path[-2].tolist() == path[-1].tolist()
    assert plan.tree is not None
    assert decode(encode(plan), Plan) == plan


def n_turns_on_the_spot(plan: Plan) -> int:
    """How often the path stands still, at both ends too."""
    return int((np.diff(maps.positions(plan), axis=0) == 0.0).all(axis=1).sum())


def smooth_part(plan: Plan) -> list[float]:
    """Changes of heading between waypoints that are apart."""
    return [
        abs(wrap_angle(b.yaw_rad - a.yaw_rad))
        for a, b in zip(plan.waypoints[:-1], plan.waypoints[1:], strict=True)
        if (a.x_m, a.y_m) != (b.x_m, b.y_m)
    ]


@pytest.mark.parametrize("part", range(4))
def test_no_plan_comes_nearer_than_the_clearance_in_hundreds_of_random_rooms(part: int) -> None:
    rng = np.random.default_rng(part)
    n_exact = n_with_turns = 0
    stretch = []
    for seed in range(75):
        grid = maps.random_room(rng)
        field = ClearanceField(grid)
        places = rng.uniform(0.0, [8.0, 6.0], (60, 2))
        places = places[maps.true_clearance(grid, places) >= maps.CLEARANCE_M][:2]
        if len(places) < 2:
            continue
        start, goal = ((*place, rng.uniform(-pi, pi)) for place in places.tolist())
        planner = PLANNERS[seed % 2]
        query = maps.query(grid, start, goal, planner=planner, seed=seed, max_iterations=1500)
        plan = make_plan(query)
        assert plan.status in ("exact", "approximate", "failed")
        if plan.status == "exact":
            assert not field.is_separated(start[:2], goal[:2], maps.CLEARANCE_M)
        if plan.status != "failed":
            check(query, plan)
        if plan.status == "exact":
            n_exact += 1
            n_with_turns += n_turns_on_the_spot(plan) > 2
            raw = np.array(plan.raw_path_m)
            stretch.append(plan.length_m / np.linalg.norm(np.diff(raw, axis=0), axis=1).sum())
    assert n_exact > 30
    assert n_with_turns < 0.1 * n_exact
    assert np.mean(stretch) < 0.95


@pytest.mark.parametrize("planner", PLANNERS)
def test_different_seeds_give_different_paths(planner: PlannerName) -> None:
    plans = [
        make_plan(replace(QUERY, planner=planner, seed=seed, max_iterations=1500)) for seed in (0, 1, 2, 2**32 - 1)
    ]
    assert len({plan.raw_path_m for plan in plans}) == 4
    assert {plan.status for plan in plans} == {"exact"}


def test_the_robot_turns_on_the_spot_at_both_ends_and_walks_along_its_heading_between() -> None:
    plan = make_plan(QUERY)
    check(QUERY, plan)
    path, waypoints = maps.positions(plan), plan.waypoints
    assert waypoints[1].yaw_rad == pytest.approx(np.arctan2(*(path[2] - path[1])[::-1]))
    assert waypoints[-2].yaw_rad == pytest.approx(np.arctan2(*(path[-2] - path[-3])[::-1]))
    steps = np.diff(path[1:-1], axis=0)
    directions = np.arctan2(steps[:, 1], steps[:, 0])
    off = [wrap_angle(w.yaw_rad - d) for w, d in zip(waypoints[1:-2], directions, strict=True)]
    assert np.abs(off).max() < 0.1
    assert max(smooth_part(plan)) < 0.15


def test_rrt_gets_out_of_a_u_shaped_trap() -> None:
    for planner in PLANNERS:
        query = maps.query(U_TRAP, (3.6, 3.0), (7.0, 3.0), planner=planner, max_iterations=4000)
        plan = make_plan(query)
        assert plan.status == "exact"
        check(query, plan)
        assert maps.positions(plan)[:, 0].min() < 2.5


@pytest.mark.parametrize("planner", PLANNERS)
def test_an_unreachable_goal_is_never_an_exact_plan(planner: PlannerName) -> None:
    grid = maps.room((0.0, 8.0, 3.0, 3.2))
    query = maps.query(grid, (1.0, 1.0), (7.0, 5.0), planner=planner, max_iterations=2000)
    plan = make_plan(query)
    assert plan.status == "approximate"
    check(query, plan)
    assert maps.positions(plan)[:, 1].max() < 3.0
    assert "No path keeps a clearance of 0.44 m: obstacles cut off the goal" in plan.reason
    assert plan.n_iterations == 2000


@pytest.mark.parametrize("planner", PLANNERS)
def test_a_budget_too_small_gives_an_approximate_plan_that_says_how_far_it_got(planner: PlannerName) -> None:
    query = replace(QUERY, planner=planner, max_iterations=20)
    plan = make_plan(query)
    assert plan.status == "approximate"
    check(query, plan)
    missing_m = np.linalg.norm(maps.positions(plan)[-1] - [7.0, 5.0])
    assert f"Ended {missing_m:.2f} m from the goal after 20 iterations: raise `planning.max_iterations`" in plan.reason
    assert plan.waypoints[-1].yaw_rad != QUERY.goal.yaw_rad


def test_a_budget_that_finds_nothing_fails() -> None:
    plan = make_plan(replace(QUERY, max_iterations=1))
    assert plan.status == "failed"
    assert (plan.waypoints, plan.raw_path_m) == ((), ())
    assert "after 1 iterations: raise `planning.max_iterations`" in plan.reason


def test_a_gate_just_wider_than_needed_is_passed_and_one_just_narrower_is_not() -> None:
    wide = maps.query(maps.gate(1.0), (6.0, 3.0), (14.0, 7.0), clearance_m=0.46)
    plan = make_plan(wide)
    assert plan.status == "exact"
    check(wide, plan)
    assert n_turns_on_the_spot(plan) == 2
    narrow = replace(wide, clearance_m=0.505, max_iterations=3000)
    plan = make_plan(narrow)
    assert plan.status == "approximate"
    assert maps.positions(plan)[:, 0].max() < 10.0


@pytest.mark.parametrize("goal", [(1.0, 1.0, 2.0), (1.0 + 1e-8, 1.0, 2.0)])
def test_a_goal_at_the_start_is_a_turn_on_the_spot(goal: tuple[float, float, float]) -> None:
    plan = make_plan(maps.query(maps.MAZE, (1.0, 1.0, -1.0), goal))
    assert plan.status == "exact"
    assert [waypoint.yaw_rad for waypoint in plan.waypoints] == [-1.0, 2.0]
    assert plan.length_m == 0.0
    assert plan.min_clearance_m == pytest.approx(0.9)
    assert decode(encode(plan), Plan) == plan


@pytest.mark.parametrize("distance_m", [1e-5, 1e-3, 0.03, 0.2])
def test_a_goal_next_to_the_start_is_reached_straight(distance_m: float) -> None:
    for planner in PLANNERS:
        query = maps.query(maps.MAZE, (1.0, 1.0), (1.0 + distance_m, 1.0), planner=planner, max_iterations=200)
        plan = make_plan(query)
        assert plan.status == "exact"
        check(query, plan)
        assert plan.length_m == pytest.approx(distance_m, rel=1e-3)


def test_a_start_and_goal_exactly_at_the_clearance_are_good() -> None:
    query = maps.query(maps.MAZE, (1.0, 0.4), (7.0, 5.6), clearance_m=0.4)
    plan = make_plan(query)
    assert plan.status == "exact"
    check(query, plan)


def test_a_map_of_coarse_cells_away_from_the_origin_is_planned_at_its_true_clearance() -> None:
    cells = np.zeros((60, 60), dtype=np.bool_)
    cells[[0, -1]] = cells[:, [0, -1]] = True
    cells[9:11, :15] = cells[49:51, :30] = cells[29:31, 19:] = True
    grid = maps.grid(cells, 1.0, (-1000.0, 500.0))
    query = maps.query(grid, (-950.0, 505.0), (-950.0, 555.0), clearance_m=0.75, step_m=1.5)
    for planner in ("rrt", "rrt_connect"):
        plan = make_plan(replace(query, planner=planner))
        assert plan.status == "exact"
        check(query, plan)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"start": maps.pose(3.0, 2.0)}, r"The start \(3, 2\) lies in an obstacle; a clearance of 0.44 m is required"),
        ({"goal": maps.pose(3.0, 2.0)}, r"The goal \(3, 2\) lies in an obstacle"),
        ({"goal": maps.pose(7.0, 4.4)}, r"The goal \(7, 4.4\) has a clearance of 0.3 m; 0.44 m is required"),
        ({"start": maps.pose(0.2, 1.0)}, r"The start \(0.2, 1\) has a clearance of 0.2 m; 0.44 m is required"),
        (
            {"start": maps.pose(8.1, 1.0)},
            r"\(8.1, 1\) lies off the map, which spans x 0 to 8 m and y 0 to 6 m",
        ),
        ({"goal": maps.pose(-1e300, 1e300)}, "The goal .* lies off the map"),
        ({"goal": maps.pose(nan, 1.0)}, "The goal .* lies off the map"),
        ({"clearance_m": nan}, "The start .* nan m is required"),
        ({"clearance_m": 50.0}, r"The start .* has a clearance of 0.9 m; 50 m is required"),
    ],
)
def test_a_pose_where_the_robot_cannot_stand_is_invalid_and_says_why(changes: dict[str, Any], reason: str) -> None:
    plan = make_plan(replace(QUERY, **changes))
    assert (plan.status, plan.waypoints, plan.raw_path_m) == ("invalid", (), ())
    assert re.search(reason, plan.reason)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"smoothing": Smoothing(max_waypoints=20, method="none")}, "waypoints: raise max_waypoints, which is 20"),
        ({"min_turning_radius_m": 3.0}, "cannot be smoothed to a turning radius of 3 m: lower it"),
    ],
)
def test_a_route_that_makes_no_path_fails_and_says_what_to_change(changes: dict[str, Any], reason: str) -> None:
    plan = make_plan(replace(QUERY, **changes))
    assert (plan.status, plan.waypoints) == ("failed", ())
    assert reason in plan.reason
    assert plan.tree is not None


def asked(planner: PlannerName, **changes: Any) -> TrunkPathQuery:
    anytime = Anytime(n_improvements=4, improvement_iterations=400)
    return maps.query(maps.MAZE, (1.0, 1.0), (7.0, 5.0), planner=planner, **({"anytime": anytime} | changes))


@pytest.mark.parametrize("planner", ALL_PLANNERS)
def test_each_revision_is_at_least_as_good_and_equal_queries_get_equal_ones(planner: PlannerName) -> None:
    revisions = plans_for(asked(planner))
    assert len(revisions) == 5
    assert {plan.status for plan in revisions} == {"exact"}
    lengths_m = [plan.length_m for plan in revisions]
    assert lengths_m == sorted(lengths_m, reverse=True)
    for plan in revisions:
        path = maps.samples(maps.positions(plan), 0.02)
        assert maps.true_clearance(maps.MAZE, path).min() >= maps.CLEARANCE_M - 1e-7
    assert plans_for(asked(planner)) == revisions


@pytest.mark.parametrize("planner", ["rrt_star", "informed_rrt_star", "bit_star", "prm_star"])
def test_the_first_answer_does_not_wait_for_the_whole_budget(planner: PlannerName) -> None:
    first = make_plan(asked(planner))
    whole = make_plan(asked(planner, anytime=None, max_iterations=3000))
    assert first.n_iterations < whole.n_iterations == 3000


@pytest.mark.parametrize("planner", ["rrt", "rrt_connect"])
def test_planners_that_find_another_path_each_time_find_a_better_one_sooner_or_later(planner: PlannerName) -> None:
    changes = {"smoothing": maps.NOT_SMOOTHED, "anytime": Anytime(n_improvements=8, improvement_iterations=3000)}
    revisions = plans_for(asked(planner, **changes))
    assert len({plan.length_m for plan in revisions}) > 1


def test_improvements_get_shorter_where_there_is_something_to_gain() -> None:
    changes = {"smoothing": maps.NOT_SMOOTHED}
    revisions = plans_for(asked("rrt_star", **changes))
    assert revisions[-1].length_m < revisions[0].length_m - 0.1
