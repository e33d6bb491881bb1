"""Paths of the box: forward only, with a minimum turning radius, and clear of everything with box and robot."""

from math import pi

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Flags, Floats
from legpush.geometry import Pose2
from legpush.messages.planning import BoxPathQuery
from legpush.plans.planner import Interrupted
from legpush.scene.scenario import Rectangle, Room
from planner_proc import box_plan
from planner_proc.box.pushes import Pushes
from planner_proc.box.search import Found, search
from planner_proc.clearance.footprint_field import FootprintField
from planner_proc.planning import make_plan
from tests.planner.boxes import OPEN, RADIUS_M, SIDES, check, faces, query, side
from tests.planner.maps import pose


@pytest.mark.parametrize(
    ("goal", "length_m", "expected"),
    [
        (pose(6.0, 4.0), 2.0, [0]),
        (pose(2.0, 4.0), 2.0, [2]),
        (pose(4.0, 5.5), 1.5, [1]),
        (pose(4.0, 2.5), 1.5, [3]),
        (pose(5.0, 5.0), 2.0, [0, 1]),
    ],
)
def test_on_an_open_floor_the_box_goes_straight_from_the_side_that_faces_away(
    goal: Pose2, length_m: float, expected: list[int]
) -> None:
    asked = query(OPEN, pose(4.0, 4.0), goal)
    plan = make_plan(asked)
    check(asked, OPEN, plan)
    assert plan.length_m == pytest.approx(length_m, abs=1e-6)
    assert sorted(faces(plan)) == expected


def test_half_a_turn_is_the_shortest_forward_path() -> None:
    one = (side(0.0, 0.4, 0.5, axle_m=0.0),)
    asked = query(OPEN, pose(4.0, 3.0), pose(4.0, 3.0 + 2 * RADIUS_M, pi), sides=one, run_in_m=0.0)
    plan = make_plan(asked)
    check(asked, OPEN, plan)
    assert plan.length_m == pytest.approx(pi * RADIUS_M, rel=1e-3)


@pytest.mark.parametrize("seed", range(6))
def test_among_obstacles_box_and_robot_stay_clear(seed: int) -> None:
    random = np.random.default_rng(seed)
    obstacles = []
    for _ in range(8):
        x_m, y_m, length_m, width_m = random.uniform([0.5, 2.0, 0.2, 0.2], [7.0, 5.5, 0.6, 0.6]).tolist()
        obstacles.append(Rectangle(x_min_m=x_m, x_max_m=x_m + length_m, y_min_m=y_m, y_max_m=y_m + width_m))
    room = Room(size_m=(8.0, 8.0), obstacles=tuple(obstacles))
    asked = query(room, pose(4.0, 1.2, 0.3), pose(4.0, 7.0, random.uniform(-pi, pi)))
    plan = make_plan(asked)
    if plan.status == "exact":
        check(asked, room, plan)
    else:
        assert plan.status in ("failed", "invalid")
    assert seed != 0 or plan.status == "exact"
    assert make_plan(asked) == plan


def test_the_side_where_the_robot_stands_already_costs_nothing_and_needs_no_way_to_it() -> None:
    room = Room(size_m=(8.0, 1.6))
    asked = query(room, pose(1.3, 0.8), pose(5.0, 0.8), sides=SIDES[:1])
    assert make_plan(replace(asked, present_side=0)).status == "exact"
    cramped = replace(asked, start=pose(1.15, 0.8))
    assert make_plan(cramped).status == "invalid"
    assert make_plan(replace(cramped, present_side=0)).status == "exact"


def test_a_goal_in_a_wall_is_refused_with_the_nearest_place() -> None:
    room = Room(size_m=(8.0, 8.0), obstacles=(Rectangle(x_min_m=5.0, x_max_m=8.0, y_min_m=0.0, y_max_m=8.0),))
    plan = make_plan(query(room, pose(3.0, 4.0), pose(5.0, 4.0)))
    assert plan.status == "invalid"
    assert "to the goal (5, 4, 0°)" in plan.reason
    assert "nearest place with this heading is 0.30 m away, at (4.70, 4.00)" in plan.reason


def test_obstacles_that_cut_off_the_goal_are_named() -> None:
    walls = (
        Rectangle(x_min_m=4.0, x_max_m=4.2, y_min_m=0.0, y_max_m=3.8),
        Rectangle(x_min_m=4.0, x_max_m=4.2, y_min_m=4.2, y_max_m=8.0),
    )
    room = Room(size_m=(8.0, 8.0), obstacles=walls)
    plan = make_plan(query(room, pose(2.5, 4.0), pose(6.0, 4.0), max_iterations=50))
    assert plan.status == "failed"
    assert "cut off the goal" in plan.reason


def test_a_side_that_is_not_there_is_refused() -> None:
    plan = make_plan(query(OPEN, pose(4.0, 4.0), pose(5.0, 4.0), present_side=4))
    assert plan.status == "invalid"
    assert "Expected present_side below 4" in plan.reason


def test_a_robot_that_cannot_walk_around_the_box_changes_no_side() -> None:
    corridor = Room(size_m=(8.0, 1.6))
    to_the_left = query(corridor, pose(3.0, 0.8), pose(2.0, 0.8), present_side=0, max_iterations=200)

    assert make_plan(to_the_left).status == "failed"
    assert make_plan(replace(to_the_left, present_side=2)).status == "exact"
    hall = Room(size_m=(8.0, 2.6))
    assert make_plan(query(hall, pose(3.0, 1.3), pose(2.0, 1.3), present_side=0)).status == "exact"


def test_a_goal_that_the_robot_has_to_come_close_to_is_pushed_into_by_less_than_the_run_in() -> None:
    obstacles = (Rectangle(x_min_m=3.4, x_max_m=3.75, y_min_m=5.75, y_max_m=6.55),)
    room = Room(size_m=(8.0, 8.0), obstacles=obstacles)
    behind_wall = query(room, pose(3.05, 4.65, -2.0), pose(5.45, 6.35, -pi / 2), max_iterations=400)
    plan = make_plan(behind_wall)

    check(behind_wall, room, plan)


def test_a_tree_leads_from_the_start_and_holds_no_more_nodes_than_a_plan_may() -> None:
    wall = Rectangle(x_min_m=3.9, x_max_m=4.1, y_min_m=1.5, y_max_m=6.5)
    room = Room(size_m=(8.0, 8.0), obstacles=(wall,))
    asked = query(room, pose(2.5, 4.0), pose(5.5, 4.0), max_iterations=400)
    plan = make_plan(asked)

    check(asked, room, plan)
    assert plan.tree is not None
    assert plan.tree.points_m[0] == (2.5, 4.0)
    assert plan.tree.parents[0] == 0
    assert all(parent < index for index, parent in enumerate(plan.tree.parents) if index)
    assert 0 < plan.n_iterations <= 400


@pytest.mark.parametrize(("n_refused", "status"), [(1, "exact"), (2, "exact"), (3, "failed")])
def test_a_path_that_does_not_keep_its_clearance_exactly_is_searched_for_again_with_more(
    n_refused: int, status: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    extra_m, free = [], FootprintField.free

    def observed(query: BoxPathQuery, pushes: Pushes, interrupted: Interrupted) -> Found:
        extra_m.append(pushes.extra_m)
        return search(query, pushes, interrupted)

    def strict(field: FootprintField, poses: Floats, clearance_m: float) -> Flags:
        is_refused = len(poses) > 1 and len(extra_m) <= n_refused
        return np.zeros(len(poses), dtype=np.bool_) if is_refused else free(field, poses, clearance_m)

    monkeypatch.setattr(box_plan, "search", observed)
    monkeypatch.setattr(FootprintField, "free", strict)
    plan = make_plan(query(OPEN, pose(4.0, 4.0), pose(6.0, 4.0)))

    assert plan.status == status
    assert extra_m == [0.05 * cells for cells in box_plan.EXTRA_CLEARANCE_CELLS[: n_refused + 1]]
