"""Faults of a path of the trunk, each of them put into an honest plan, and the exact clearance."""

from collections.abc import Callable
from math import pi

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.clearance import Occupied, clearance
from legpush.scene.footprints import robot_footprint
from planner_proc.clearance.field import ClearanceField
from planner_proc.conformance.bench import EASY
from planner_proc.conformance.cases import BESIDE_A_WALL
from planner_proc.conformance.truth import differences, faults
from planner_proc.planning import make_plan
from tests.planner.bodies import BODY, least_distance_m
from tests.planner.maps import grid, random_room
from tests.robots import ROBOT


@pytest.mark.parametrize("seed", range(12))
def test_clearance_is_that_of_the_planner_to_the_last_digit(seed: int) -> None:
    random = np.random.default_rng(seed)
    room = random_room(random)
    points = random.uniform([0.3, 0.3], [7.7, 5.7], (5, 2))
    points = points[ClearanceField(room).clearance_m(points) > 0.0]
    if len(points) < 2:
        points = np.array([[0.05, 0.05], [0.05, 0.06]])

    expected = ClearanceField(room).path_clearance_m(points)
    nearest = clearance(room, points)

    assert nearest.distance_m == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_the_distance_of_a_rectangle_is_that_of_polygons(seed: int) -> None:
    random = np.random.default_rng(seed)
    occupied = Occupied(random_room(random))
    for x_m, y_m, yaw_rad in random.uniform([-0.3, -0.3, -np.pi], [8.3, 6.3, np.pi], (40, 3)).tolist():
        pose = np.array([[x_m, y_m, yaw_rad]] * 2)
        rectangle = robot_footprint(ROBOT, Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad))
        expected_m = least_distance_m(occupied.grid, BODY, pose)
        assert occupied.distance_m(rectangle) == pytest.approx(expected_m, abs=1e-9)


def test_a_path_for_a_disc_alone_has_a_fault_where_the_body_turns_into_a_wall() -> None:
    of_body, of_disc = make_plan(BESIDE_A_WALL), make_plan(replace(BESIDE_A_WALL, body=None))

    assert faults(BESIDE_A_WALL, of_body) == []
    (fault,) = faults(BESIDE_A_WALL, of_disc)
    assert "the body collides: near (4.00, 0.50)" in fault


def test_a_point_alone_and_an_empty_map_have_a_clearance() -> None:
    empty = grid(np.zeros((10, 20), dtype=np.bool_))

    assert clearance(empty, np.array([[0.5, 0.4]])).distance_m == pytest.approx(0.4)
    assert clearance(empty, np.array([[0.5, 0.4], [1.9, 0.4]])).distance_m == pytest.approx(0.1)
    assert clearance(empty, np.array([[0.5, 0.4], [2.5, 0.4]])).distance_m == 0.0


STEERED = replace(EASY, planner="rrt", steering="dubins", min_turning_radius_m=0.5, max_iterations=5000)


def each(change: Callable[[int, Pose2], Pose2]) -> Callable[[Plan], Plan]:
    """The plan with its waypoints changed by their numbers."""
    return lambda plan: replace(plan, waypoints=tuple(change(k, pose) for k, pose in enumerate(plan.waypoints)))


@pytest.mark.parametrize("query", [EASY, STEERED])
def test_an_honest_path_of_the_trunk_has_no_faults(query: TrunkPathQuery) -> None:
    plan = make_plan(query)

    assert plan.status == "exact", plan.reason
    assert faults(query, plan) == []


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda plan: replace(plan, waypoints=()), "its status is exact, and it has no waypoints"),
        (lambda plan: replace(plan, status="failed", reason=""), "its status is failed, and its reason is empty"),
        (lambda plan: replace(plan, waypoints=plan.waypoints[:-20]), "it ends at"),
        (lambda plan: replace(plan, waypoints=plan.waypoints[::20]), "m apart, expected at most 0.25 m"),
        (each(lambda _, at: replace(at, x_m=100 * at.x_m, y_m=100 * at.y_m)), "are these centimetres?"),
        (each(lambda _, at: replace(at, x_m=20 * at.x_m, y_m=20 * at.y_m)), "are these cells?"),
        (each(lambda _, at: replace(at, yaw_rad=at.yaw_rad + 30.0)), "are these degrees?"),
        (each(lambda k, at: replace(at, x_m=min(at.x_m, 3.6) if 3 < k < 200 else at.x_m)), "m apart"),
        (each(lambda k, at: replace(at, y_m=max(at.y_m - 0.6, 1.0))), "it collides: near"),
    ],
)
def test_each_fault_of_a_path_of_the_trunk_is_named(change: Callable[[Plan], Plan], words: str) -> None:
    assert words in "; ".join(faults(EASY, change(make_plan(EASY))))


def test_exchanged_axes_are_named() -> None:
    asked = replace(EASY, start=Pose2(x_m=1.0, y_m=1.5, yaw_rad=0.0))
    plan = each(lambda _, at: replace(at, x_m=at.y_m, y_m=at.x_m))(make_plan(asked))

    assert "it begins at (1.5, 1), 0.707 m from (1, 1.5); are x and y the wrong way around?" in "; ".join(
        faults(asked, plan)
    )


def test_a_steered_path_that_turns_tightly_or_moves_backward_is_named() -> None:
    plan = make_plan(STEERED)

    tighter = "; ".join(faults(replace(STEERED, min_turning_radius_m=1.0), plan))
    assert "it turns on a radius of 0.5" in tighter
    assert "expected at least 1 m" in tighter
    backward = each(lambda _, at: replace(at, yaw_rad=at.yaw_rad + pi))(plan)
    assert "it does not move forward along its heading" in "; ".join(faults(STEERED, backward))


def test_the_first_difference_of_two_plans_is_named() -> None:
    plan = make_plan(EASY)
    shifted = replace(plan, waypoints=(*plan.waypoints[:3], plan.waypoints[0], *plan.waypoints[4:]))

    assert differences(plan, plan) == ""
    assert differences(plan, replace(plan, length_m=1.0)) == f"`length_m` is {plan.length_m} and 1.0"
    assert differences(plan, replace(plan, sides=(0,))) == "`sides` has 0 and 1 entries"
    assert differences(plan, shifted).startswith("`waypoints[3]` is Pose2(")
    assert differences(plan, replace(plan, tree=None)) == "`tree` differs"
