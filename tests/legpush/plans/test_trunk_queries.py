"""Queries for paths of the trunk: where they lead, around what, and with which clearance."""

from typing import get_args

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.planning import TrunkPathQuery
from legpush.plans.trunk_queries import SLACK_M, query_to_measured_box, query_to_nominal_box, query_to_pose
from legpush.scenarios.file import load_scenario
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.footprints import box_footprint
from legpush.scene.names import Face
from legpush.scene.occupancy import clearance_m, occupancy_grid
from legpush.scene.station import nominal_obstacle, stand_off
from tests.distances import clearance_at
from tests.robots import CIRCLE_M

SCENARIO = load_scenario("default")
START = SCENARIO.start.pose()
BOX = Pose2(x_m=8.0, y_m=6.5, yaw_rad=0.4)


def n_occupied(query: TrunkPathQuery) -> int:
    return int(np.frombuffer(query.grid.cells, dtype=np.uint8).sum())


@pytest.mark.parametrize("face", get_args(Face))
def test_the_way_to_the_box_ends_at_the_stand_off_behind_the_face(face: Face) -> None:
    query = query_to_measured_box(SCENARIO, 3, START, BOX, face)
    assert (query.start, query.seed) == (START, 3)
    assert query.goal == stand_off(SCENARIO, pushed_box(SCENARIO.box, face), pushed_pose(BOX, face))
    assert query.grid == occupancy_grid(SCENARIO.room, [box_footprint(SCENARIO.box, BOX)])


def test_from_far_away_everything_is_avoided_that_the_box_may_cover() -> None:
    nominal = SCENARIO.box.pose.pose()
    far, near = (
        query_to_nominal_box(SCENARIO, 3, START, "rear"),
        query_to_measured_box(SCENARIO, 3, START, nominal, "rear"),
    )
    assert far.goal == near.goal
    assert far.grid == occupancy_grid(SCENARIO.room, [nominal_obstacle(SCENARIO)])
    assert n_occupied(far) >= n_occupied(near)


def test_the_planner_is_asked_as_the_scenario_says() -> None:
    planning = replace(SCENARIO.planning, planner="prm_star", max_iterations=77, step_m=0.3, goal_bias=0.2)
    scenario = replace(SCENARIO, planning=planning)
    query = query_to_pose(scenario, 3, START, BOX, BOX)
    assert (query.planner, query.max_iterations, query.step_m, query.goal_bias) == ("prm_star", 77, 0.3, 0.2)
    assert query.goal == BOX
    assert query.clearance_m == clearance_m(scenario)


def test_a_robot_near_an_obstacle_keeps_what_it_has_but_no_less_than_half_its_width() -> None:
    wanted_m, least_m = clearance_m(SCENARIO), SCENARIO.robot.stance.body_width_m / 2
    asked = []
    for y_m in np.linspace(CIRCLE_M / 2, START.y_m, 20):
        start = Pose2(x_m=START.x_m, y_m=float(y_m), yaw_rad=0.0)
        query = query_to_pose(SCENARIO, 0, start, BOX, BOX)
        present_m = clearance_at(query.grid, start)
        assert query.clearance_m == min(wanted_m, max(present_m - SLACK_M, least_m))
        asked.append(query.clearance_m)
    assert asked[0] == least_m < asked[-1] == wanted_m
