"""Plans whose body keeps its clearance, turns on the spot included, judged by polygons."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.messages.planning import Plan
from planner_proc.body.fitting import BodyFitting
from planner_proc.clearance.field import ClearanceField
from planner_proc.planning import make_plan
from tests.planner.bodies import BODY, BODY_M, body_query, least_distance_m, poses_of
from tests.planner.maps import query, random_room, room

CORRIDOR = room((0.0, 8.0, 0.0, 2.5), (0.0, 8.0, 3.5, 6.0))
"""1 m wide: the disc turns in it, the body does not."""


def test_a_path_that_fits_is_the_one_of_the_disc() -> None:
    asked = query(room(), (2.0, 3.0), (6.0, 3.0))

    assert make_plan(replace(asked, body=BODY, body_clearance_m=BODY_M)) == make_plan(asked)


def test_a_robot_beside_a_wall_leaves_it_before_it_turns() -> None:
    asked = body_query(room(), (4.0, 0.5, np.pi), (6.0, 2.0, 0.0), clearance_m=0.44)
    plan, of_disc = make_plan(asked), make_plan(replace(asked, body=None))

    assert (plan.status, of_disc.status) == ("exact", "exact")
    assert least_distance_m(asked.grid, BODY, poses_of(of_disc)) == 0.0
    assert least_distance_m(asked.grid, BODY, poses_of(plan)) >= BODY_M - 0.01
    assert (plan.waypoints[0], plan.waypoints[-1]) == (asked.start, asked.goal)
    steps = np.diff(poses_of(plan), axis=0)
    assert np.hypot(*steps[:, :2].T).max() < 0.06
    assert plan.length_m == pytest.approx(np.hypot(*steps[:, :2].T).sum())


def test_a_robot_that_cannot_turn_anywhere_has_no_path() -> None:
    plan = make_plan(body_query(CORRIDOR, (2.0, 3.0), (6.0, 3.0, np.pi), clearance_m=0.35))

    assert plan.status == "failed"
    assert "The body of the robot does not keep 0.05 m everywhere" in plan.reason
    assert make_plan(body_query(CORRIDOR, (2.0, 3.0), (6.0, 3.0), clearance_m=0.35)).status == "exact"


def test_a_curve_is_not_replaced_by_turns_on_the_spot() -> None:
    asked = body_query(room(), (4.0, 0.5), (6.0, 0.5), clearance_m=0.44, steering="dubins", min_turning_radius_m=0.5)
    fitting = BodyFitting(asked, ClearanceField(asked.grid))
    touching = Plan(status="exact", reason="", waypoints=(asked.start, replace(asked.start, yaw_rad=1.5), asked.goal))

    assert fitting.fitted(touching).status == "failed"


@pytest.mark.parametrize("seed", range(8))
def test_in_any_room_an_exact_plan_keeps_the_body_from_everything(seed: int) -> None:
    random = np.random.default_rng(seed)
    for _ in range(6):
        start, goal = random.uniform([0.7, 0.7, -np.pi], [7.3, 5.3, np.pi], (2, 3)).tolist()
        asked = body_query(random_room(random), tuple(start), tuple(goal))
        ends = np.array([start, start]), np.array([goal, goal])
        if min(least_distance_m(asked.grid, BODY, each) for each in ends) < BODY_M:
            continue
        plan = make_plan(asked)
        if plan.status == "exact":
            assert least_distance_m(asked.grid, BODY, poses_of(plan)) >= BODY_M - 0.012
            assert make_plan(asked) == plan
