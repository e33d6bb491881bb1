"""Paths with a turning radius: forward only, and backward too."""

from itertools import pairwise
from math import cos, hypot, pi, sin
from typing import get_args

import numpy as np
import pytest

from legpush.geometry import wrap_angle
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.names import PlannerName, Steering
from legpush.scene.plan_settings import NOT_STEERED, Anytime
from planner_proc.clearance.field import ClearanceField
from planner_proc.planning import make_plan
from planner_proc.search.steering import Curved
from tests.planner import maps

RADIUS_M = 0.5
STEERED: list[tuple[PlannerName, Steering]] = [
    (planner, steering)
    for steering in ("dubins", "reeds_shepp")
    for planner in get_args(PlannerName)
    if steering not in NOT_STEERED.get(planner, ())
]


def steered(planner: PlannerName, steering: Steering, **changes: object) -> TrunkPathQuery:
    fields: dict[str, object] = {
        "planner": planner,
        "steering": steering,
        "min_turning_radius_m": RADIUS_M,
        "max_iterations": 4000,
        "anytime": Anytime(n_improvements=1, improvement_iterations=1),
    }
    return maps.query(maps.MAZE, (1.0, 1.0, 0.0), (7.0, 5.0, 0.2), **(fields | changes))


def directions(plan: Plan) -> set[int]:
    """Whether it moves forward, 1, or backward, -1, or both; and that it moves along its heading and turns wide."""
    found = set()
    for a, b in pairwise(plan.waypoints):
        dx, dy = b.x_m - a.x_m, b.y_m - a.y_m
        step_m, turn_rad = hypot(dx, dy), wrap_angle(b.yaw_rad - a.yaw_rad)
        assert step_m <= 0.05 + 1e-9
        assert abs(turn_rad) <= 1.01 * 0.05 / RADIUS_M
        if step_m > 0.001:
            along_m = dx * cos(a.yaw_rad + turn_rad / 2) + dy * sin(a.yaw_rad + turn_rad / 2)
            assert abs(along_m) >= 0.9 * step_m
            found.add(1 if along_m > 0.0 else -1)
    return found


@pytest.mark.parametrize(("planner", "steering"), STEERED)
def test_a_steered_path_keeps_clearance_radius_and_both_headings(planner: PlannerName, steering: Steering) -> None:
    query = steered(planner, steering)
    plan = make_plan(query)
    assert plan.status == "exact", plan.reason
    assert (plan.waypoints[0], plan.waypoints[-1]) == (query.start, query.goal)
    path = maps.positions(plan)
    assert maps.true_clearance(maps.MAZE, maps.samples(path, 0.01)).min() >= maps.CLEARANCE_M - 1e-7
    assert directions(plan) <= ({1} if steering == "dubins" else {1, -1})
    assert plan.length_m == pytest.approx(np.hypot(*np.diff(path, axis=0).T).sum())


def test_a_robot_that_may_go_backward_parks_by_a_shorter_way() -> None:
    grid = maps.room()
    lengths = {}
    for steering in ("dubins", "reeds_shepp"):
        changes = {"planner": "rrt", "steering": steering, "min_turning_radius_m": 0.8}
        plan = make_plan(maps.query(grid, (4.0, 3.0, 0.0), (3.5, 3.0, 0.0), **changes))
        assert plan.status == "exact"
        lengths[steering] = plan.length_m
    assert lengths["reeds_shepp"] == pytest.approx(0.5, abs=0.01)
    assert lengths["dubins"] > 2.0


def test_a_turn_at_the_start_takes_a_way_where_the_robot_cannot_turn_on_the_spot() -> None:
    plan = make_plan(
        maps.query(
            maps.room(),
            (4.0, 3.0, 0.0),
            (4.0, 3.0, 3.1),
            planner="rrt_star",
            steering="dubins",
            min_turning_radius_m=0.5,
            max_iterations=300,
        )
    )
    assert plan.status == "exact"
    assert plan.length_m > 3.0


def test_the_poses_of_a_curve_lead_all_the_way_to_each_cusp_and_back() -> None:
    query = maps.query(
        maps.room(), (4.0, 3.0), (5.0, 3.0), steering="reeds_shepp", min_turning_radius_m=0.9, planner="rrt_star"
    )
    steer = Curved(query, ClearanceField(query.grid))
    rng = np.random.default_rng(0)
    n_cusps = 0
    for _ in range(200):
        a, b = (
            steer.state(maps.pose(x_m, y_m, rng.uniform(-np.pi, np.pi)))
            for x_m, y_m in rng.uniform(3.0, 4.0, (2, 2)).tolist()
        )
        poses = steer.curve([a, b])
        assert poses is not None
        steps = np.diff(poses[:, :2], axis=0)
        n_cusps += int(((steps[:-1] * steps[1:]).sum(axis=1) < 0.0).sum())
        assert np.hypot(*steps.T).sum() == pytest.approx(steer.space.distance(a, b), abs=4e-3)
    assert n_cusps > 100


@pytest.mark.parametrize(
    ("planner", "steering"), [("rrt", "dubins"), ("rrt_connect", "reeds_shepp"), ("bit_star", "dubins")]
)
@pytest.mark.parametrize("yaw_rad", [pi, -pi, 7.0])
def test_headings_may_be_any_number_at_both_ends(planner: PlannerName, steering: Steering, yaw_rad: float) -> None:
    changes = {"planner": planner, "steering": steering, "min_turning_radius_m": 0.5, "max_iterations": 2000}
    query = maps.query(maps.room(), (5.0, 2.0, yaw_rad), (3.0, 4.0, yaw_rad), **changes)
    plan = make_plan(query)
    assert plan.status == "exact", plan.reason
    assert (plan.waypoints[0], plan.waypoints[-1]) == (query.start, query.goal)


@pytest.mark.parametrize("radius_m", [0.005, 0.02])
def test_a_tiny_turning_radius_asks_for_no_more_space_than_a_large_one(radius_m: float) -> None:
    gate = maps.room((3.9, 4.1, 0.0, 2.5), (3.9, 4.1, 3.5, 6.0))
    changes = {"planner": "rrt", "steering": "dubins", "min_turning_radius_m": radius_m, "max_iterations": 3000}
    assert make_plan(maps.query(gate, (2.0, 3.0), (6.0, 3.0), **changes)).status == "exact"
