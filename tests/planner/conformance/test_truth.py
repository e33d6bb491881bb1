"""What plan-check knows about clearance, against every square looked at, and about paths of the box."""

from collections.abc import Callable
from math import pi

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.planning import Plan
from legpush.scene.clearance import clearance
from planner_proc.clearance.field import ClearanceField
from planner_proc.conformance.box_truth import box_faults
from planner_proc.conformance.cases import ASIDE, box_query
from planner_proc.planning import make_plan
from tests.planner.maps import grid, random_room


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


def test_a_point_alone_and_an_empty_map_have_a_clearance() -> None:
    empty = grid(np.zeros((10, 20), dtype=np.bool_))

    assert clearance(empty, np.array([[0.5, 0.4]])).distance_m == pytest.approx(0.4)
    assert clearance(empty, np.array([[0.5, 0.4], [1.9, 0.4]])).distance_m == pytest.approx(0.1)
    assert clearance(empty, np.array([[0.5, 0.4], [2.5, 0.4]])).distance_m == 0.0


BOX = box_query(ASIDE)


def each(change: Callable[[int, Pose2], Pose2]) -> Callable[[Plan], Plan]:
    """The plan with its waypoints changed by their numbers."""
    return lambda plan: replace(plan, waypoints=tuple(change(k, pose) for k, pose in enumerate(plan.waypoints)))


def test_an_honest_path_of_the_box_has_no_faults() -> None:
    plan = make_plan(BOX)

    assert plan.status == "exact", plan.reason
    assert box_faults(BOX, plan) == []


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda plan: replace(plan, sides=()), "waypoints and 0 sides, expected equally many"),
        (lambda plan: replace(plan, sides=(3,) * len(plan.sides)), "it pushes side 3, expected one below 1"),
        (lambda plan: replace(plan, waypoints=plan.waypoints[:9], sides=plan.sides[:9]), "the box ends at"),
        (each(lambda _, at: replace(at, x_m=100 * at.x_m)), "the box begins at (300, 3)"),
        (each(lambda _, at: replace(at, yaw_rad=at.yaw_rad + pi)), "side 0 is pulled: the box moves backward"),
        (each(lambda k, at: replace(at, y_m=at.y_m + 0.01 * (k % 2))), "the box slips sideways"),
        (
            each(lambda k, at: replace(at, yaw_rad=at.yaw_rad + 0.1 * (k % 2))),
            "it turns on a radius below the 0.7 m of side 0",
        ),
        (
            lambda plan: replace(plan, waypoints=plan.waypoints[::30], sides=plan.sides[::30]),
            "farther than 0.25 m apart",
        ),
        (each(lambda _, at: replace(at, y_m=at.y_m - 2.8)), "it collides: near"),
    ],
)
def test_each_fault_of_a_path_of_the_box_is_named(change: Callable[[Plan], Plan], words: str) -> None:
    assert words in "; ".join(box_faults(BOX, change(make_plan(BOX))))
