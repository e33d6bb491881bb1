"""Stages, what they cost, and whether box and robot fit along them."""

from itertools import pairwise
from math import pi

import pytest

from legpush.geometry import Pose2
from legpush.scene.scenario import Rectangle, Room
from planner_proc.box.pushes import Pushes, Way
from planner_proc.clearance.field import ClearanceField
from tests.planner.boxes import CLEARANCE_M, OPEN, SIDES, query
from tests.planner.maps import pose

START, GOAL = pose(4.0, 4.0), pose(5.5, 4.6)


def pushes_in(room: Room, start: Pose2 = START, goal: Pose2 = GOAL) -> Pushes:
    asked = query(room, start, goal)
    return Pushes(asked, ClearanceField(asked.grid))


def assert_leads(way: Way, start: Pose2, goal: Pose2) -> None:
    assert (way[0].begin, way[-1].end) == (start, goal)
    assert all(a.end == b.begin for a, b in pairwise(way))


def test_the_cost_is_the_length_and_so_much_for_each_change_of_sides() -> None:
    pushes = pushes_in(OPEN)
    way = (pushes.stage(0, START, pose(5.0, 4.0)), pushes.stage(1, pose(5.0, 4.0), pose(5.0, 4.6)))

    assert [stage.length_m for stage in way] == pytest.approx([1.0, 0.6])
    assert pushes.cost_m(way, 0) == pytest.approx(1.6 + 0.5)
    assert pushes.cost_m(way, None) == pytest.approx(1.6 + 2 * 0.5)
    assert pushes.cost_m(way, 1) == pytest.approx(1.6 + 2 * 0.5)


def test_from_one_side_there_is_a_push_per_side_and_from_two_a_straight_stage_and_another() -> None:
    pushes = pushes_in(OPEN)
    one, two = list(pushes.one_side(START, GOAL)), list(pushes.two_sides(START, GOAL))

    assert [way[0].side for way in one] == [0, 1, 2, 3]
    assert len(two) > 3
    for way in (*one, *two):
        assert_leads(way, START, GOAL)
    assert all(len({stage.side for stage in way}) == 2 for way in two)
    lengths_m = [sum(stage.length_m for stage in way) for way in two]
    assert min(lengths_m) == pytest.approx(1.5 + 0.6), "straight ahead, then straight to the left"


def test_ways_to_the_goal_end_with_the_run_in() -> None:
    pushes = pushes_in(OPEN)
    with_run_in = [way for way in pushes.to_goal(START, GOAL) if len(way) == 2 and way[0].side == way[1].side]

    assert len(with_run_in) == len(SIDES)
    for way in with_run_in:
        assert_leads(way, START, GOAL)
        assert way[1].length_m == pytest.approx(0.4)
        assert way[1].begin.yaw_rad == GOAL.yaw_rad


def test_a_straight_push_that_passes_within_the_tolerances_needs_no_turn() -> None:
    goal = pose(5.5, 4.005, 0.01)
    straight = [way for way in pushes_in(OPEN, goal=goal).to_goal(START, goal) if len(way) == 1 and way[0].side == 0]

    (way,) = straight
    assert way[0].length_m == pytest.approx(1.5)
    assert (way[0].end.y_m, way[0].end.yaw_rad) == (4.0, 0.0)


def test_the_best_way_is_the_cheapest_free_one_below_a_cost() -> None:
    wall = Rectangle(x_min_m=4.6, x_max_m=4.8, y_min_m=4.3, y_max_m=8.0)
    goal = pose(4.0, 5.5)
    pushes = pushes_in(Room(size_m=(8.0, 8.0), obstacles=(wall,)), goal=goal)
    ways = [(pushes.stage(side, START, goal),) for side in range(4)]

    assert pushes.best(iter(ways), None, 10.0, 4) == ways[1]
    assert pushes.best(iter(ways), None, 1.9, 4) is None, "1.5 m, and a change of sides for 0.5 m"
    assert pushes.best(iter(ways), 1, 1.9, 4) == ways[1]
    assert pushes.best(iter([ways[0], ways[2]]), None, 100.0, 0) is None


def test_a_push_through_a_wall_is_not_free_and_one_that_begins_too_near_to_it_cannot_begin() -> None:
    wall = Rectangle(x_min_m=4.6, x_max_m=4.8, y_min_m=0.0, y_max_m=8.0)
    pushes = pushes_in(Room(size_m=(8.0, 8.0), obstacles=(wall,)))
    side = pushes.sides[0]

    assert not pushes.free((pushes.stage(0, START, pose(5.5, 4.0)),), 0)
    assert pushes.free((pushes.stage(0, START, pose(4.3, 4.0)),), 0)
    assert side.fits(pose(4.3, 4.0))
    assert not side.fits(pose(4.4, 4.0))
    assert side.fits(pose(1.2, 4.0))
    assert not side.can_begin(pose(1.2, 4.0)), "the robot walks in from farther back than it pushes"


def test_the_search_may_be_asked_to_keep_more_than_is_required() -> None:
    room = Room(size_m=(8.0, 1.0))
    pushes = pushes_in(room, pose(2.0, 0.5), pose(4.0, 0.5))
    stage = pushes.stage(0, pose(2.0, 0.5), pose(4.0, 0.5))

    assert pushes.free((stage,), 0)
    pushes.extra_m = 0.5 - 0.25 - CLEARANCE_M
    assert not pushes.free((stage,), 0)


def test_a_side_goes_ahead_in_its_own_direction() -> None:
    side = pushes_in(OPEN).sides[1]
    stage = pushes_in(OPEN).stage(1, START, pose(4.0, 5.0))

    assert side.turn_rad == pi / 2
    assert side.ahead(START, 0.5).xy() == pytest.approx([4.0, 4.5])
    assert side.ahead(START, -0.5).xy() == pytest.approx([4.0, 3.5])
    assert side.along(START, stage.end, 0.25).xy() == pytest.approx([4.0, 4.25])
    assert side.box(side.pushed(stage))[-1].tolist() == pytest.approx([4.0, 5.0, 0.0])
