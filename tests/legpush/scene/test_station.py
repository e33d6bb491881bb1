"""Where the robot stands relative to the box, and what it asks the planner."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.geometry import Pose2
from legpush.plans.trunk_queries import query_to_measured_box
from legpush.realism.settings import Randomization
from legpush.scene.footprints import (
    box_footprint,
    distance_m,
    distance_to_point_m,
    obstacle_footprint,
    robot_footprint,
)
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.scenario import Rectangle, Room
from legpush.scene.station import at_station, last_stretch, nominal_obstacle, stand_off, station, way_back
from tests.agent.fake_world import make_scenario
from tests.distances import clearance_at
from tests.robots import CIRCLE_M, ROBOT

poses = st.builds(Pose2, x_m=st.floats(3.0, 9.0), y_m=st.floats(2.0, 4.0), yaw_rad=st.floats(-pi, pi))


@given(box=poses)
def test_at_the_station_the_front_feet_are_the_gap_behind_the_box(box: Pose2) -> None:
    scenario = make_scenario()

    trunk = station(ROBOT, scenario.box, box)

    feet = (box.inverse() @ trunk).apply(ROBOT.stance.foot_rectangle_b())
    np.testing.assert_allclose(feet[:2, 0], -0.2 - ROBOT.pushing.gap_m, atol=1e-3)
    np.testing.assert_allclose(feet[0, 1], -feet[1, 1], atol=1e-9)


@given(box=poses)
def test_the_last_stretch_leads_straight_from_the_stand_off_to_the_station(box: Pose2) -> None:
    scenario = make_scenario()

    seen = [box.inverse() @ pose for pose in last_stretch(scenario, scenario.box, box)]

    begin, end = (
        box.inverse() @ stand_off(scenario, scenario.box, box),
        box.inverse() @ station(ROBOT, scenario.box, box),
    )
    ahead = [begin.x_m, *(pose.x_m for pose in seen)]
    assert ahead[-1] == pytest.approx(end.x_m)
    assert all(0.0 < step <= 0.05 + 1e-9 for step in np.diff(ahead))
    assert all(abs(pose.y_m) < 1e-9 and abs(pose.yaw_rad) < 1e-9 for pose in seen)


def test_the_stand_off_clears_the_box_wherever_the_seed_puts_it() -> None:
    offsets = Randomization(box_xy_m=0.3, box_yaw_deg=20.0)
    scenario = make_scenario(randomization=offsets)
    place = stand_off(scenario, scenario.box, scenario.box.pose.pose())

    assert distance_to_point_m(nominal_obstacle(scenario), place.xy()) > CIRCLE_M + 0.1


@given(x=st.floats(-0.05, 0.05), y=st.floats(-0.05, 0.05), turn=st.floats(-5.0, 5.0))
def test_the_obstacle_covers_the_box_wherever_the_seed_puts_it(x: float, y: float, turn: float) -> None:
    scenario = make_scenario(randomization=Randomization(box_xy_m=0.05, box_yaw_deg=5.0))
    nominal = scenario.box.pose.pose()
    box = Pose2(x_m=nominal.x_m + x, y_m=nominal.y_m + y, yaw_rad=nominal.yaw_rad + radians(turn))

    for corner in box_footprint(scenario.box, box).corners():
        assert distance_to_point_m(nominal_obstacle(scenario), corner) <= 1e-9


@pytest.mark.parametrize(
    ("x_m", "y_m", "turn_deg", "expected"),
    [(0.0, 0.0, 0.0, True), (0.1, -0.1, 10.0, True), (0.2, 0.0, 0.0, False), (0.0, 0.0, 20.0, False)],
)
def test_the_robot_is_at_the_station_where_it_can_push_from(
    x_m: float, y_m: float, turn_deg: float, expected: bool
) -> None:
    scenario = make_scenario()
    box = Pose2(x_m=6.0, y_m=3.0, yaw_rad=pi)
    trunk = station(ROBOT, scenario.box, box) @ Pose2(x_m=x_m, y_m=y_m, yaw_rad=radians(turn_deg))

    assert at_station(ROBOT, trunk, scenario.box, box) is expected


@pytest.mark.parametrize(
    ("point", "expected_m"),
    [
        ((0.5, 0.5), 0.5),
        ((1.5, 2.2), 0.2),
        ((0.25, 2.75), 0.25),
        ((1.5, 0.9), 0.1),
        ((1.2, 1.3), 0.0),
        ((0.7, 0.6), 0.5),
    ],
)
def test_the_distance_to_what_is_occupied_is_that_to_the_square_or_the_border(
    point: tuple[float, float], expected_m: float
) -> None:
    grid = OccupancyGrid(
        n_columns=3, n_rows=3, resolution_m=1.0, origin_m=(10.0, 0.0), cells=bytes([0, 0, 0, 0, 1, 0, 0, 0, 0])
    )

    distance_m = clearance_at(grid, Pose2(x_m=10.0 + point[0], y_m=point[1], yaw_rad=0.0))

    assert distance_m == pytest.approx(expected_m, abs=1e-9)


def test_a_robot_that_stands_in_a_wall_asks_for_half_its_width() -> None:
    wall = Rectangle(x_min_m=0.0, x_max_m=12.0, y_min_m=0.0, y_max_m=2.8)
    scenario = make_scenario(room=Room(size_m=(12.0, 6.0), obstacles=(wall,)))

    query = query_to_measured_box(scenario, 3, scenario.start.pose(), scenario.box.pose.pose(), "rear")

    assert query.clearance_m == scenario.robot.stance.body_width_m / 2
    assert query.body is not None
    assert query.body.width_m < scenario.robot.stance.body_width_m
    assert 0.0 <= query.body_clearance_m < scenario.planning.body_margin_m
    assert (query.seed, query.planner) == (3, "rrt_connect")


def test_the_gap_and_the_feet_make_the_distance_to_the_box() -> None:
    scenario = make_scenario()
    box = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)

    assert station(ROBOT, scenario.box, box).x_m == pytest.approx(
        -(0.2 + ROBOT.pushing.gap_m + ROBOT.stance.foot_rectangle_length_m / 2), abs=1e-3
    )


def test_the_way_back_ends_before_the_body_comes_too_near_to_a_wall() -> None:
    wall = Rectangle(x_min_m=0.0, x_max_m=4.5, y_min_m=0.0, y_max_m=6.0)
    scenario = make_scenario(room=Room(size_m=(12.0, 6.0), obstacles=(wall,)))
    box = Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.0)
    trunk = station(ROBOT, scenario.box, box)

    free, kept = (way_back(each, trunk, box) for each in (make_scenario(), scenario))
    body = robot_footprint(ROBOT, kept[-1])

    assert kept == free[: len(kept)]
    assert len(kept) < len(free)
    assert 0.05 <= distance_m(body, obstacle_footprint(wall)) < 0.05 + 0.05
