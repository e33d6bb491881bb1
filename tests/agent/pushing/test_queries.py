"""Queries for paths of the box: what the planner is told of box, robot, faces and goal."""

from math import degrees, radians

import pytest
from msgspec.structs import replace

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.docking.moves import PUSH_S, QUARTER_S
from agent_proc.pushing.queries import TOLERANCE_SHARE, calibration_query, query_for_box
from legpush.geometry import Pose2, distance_m
from legpush.messages.planning import BoxPathQuery
from legpush.messages.stepping import Push
from legpush.scene.faces import FACES, TURN_RAD, pushed_box, pushed_pose
from legpush.scene.footprints import robot_footprint
from legpush.scene.names import Face
from legpush.scene.scenario import PushSettings, Scenario
from legpush.scene.station import stand_off, station
from tests.agent.fake_world import make_scenario
from tests.robots import ROBOT

HERE = Pose2(x_m=5.0, y_m=2.0, yaw_rad=0.3)
SCENARIO = make_scenario()


def estimates(scenario: Scenario, *faces: Face) -> dict[Face, PushEstimate]:
    return {face: PushEstimate(pushed_box(scenario.box, face)) for face in faces}


def query(scenario: Scenario, *faces: Face, present: Face | None = None) -> BoxPathQuery:
    return query_for_box(scenario, 5, HERE, estimates(scenario, *faces), present)


def test_a_path_leads_from_the_box_to_its_goal_and_may_miss_it_by_a_share_of_the_tolerances() -> None:
    asked = query(SCENARIO, *FACES)

    assert (asked.start, asked.goal, asked.seed) == (HERE, SCENARIO.goal.pose.pose(), 5)
    assert asked.position_tolerance_m == TOLERANCE_SHARE * SCENARIO.goal.position_tolerance_m
    assert degrees(asked.angle_tolerance_rad) == pytest.approx(TOLERANCE_SHARE * SCENARIO.goal.angle_tolerance_deg)


def test_the_planner_is_asked_as_the_scenario_says() -> None:
    pushing = PushSettings(margin_m=0.07, face_change_m=3.5, run_in_m=0.25, max_iterations=123, goal_bias=0.2)

    asked = query(replace(SCENARIO, pushing=pushing), "rear")

    assert (asked.clearance_m, asked.side_change_m, asked.run_in_m) == (0.07, 3.5, 0.25)
    assert (asked.max_iterations, asked.goal_bias, asked.step_m) == (123, 0.2, pushing.step_m)


def test_a_walk_costs_as_far_as_this_very_box_is_pushed_meanwhile() -> None:
    light, heavy = PushEstimate(SCENARIO.box), PushEstimate(SCENARIO.box)
    before = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    for _ in range(4):
        push = Push(w1=light.curve[0], w2=light.curve[1], leg="FL", depth_m=0.05)
        heavy.learn(before, push, Pose2(x_m=0.015, y_m=0.0, yaw_rad=0.0))
    fast, slow = (
        query_for_box(SCENARIO, 5, HERE, {"rear": estimate}, None).side_change_m for estimate in (light, heavy)
    )

    assert fast == pytest.approx(QUARTER_S / PUSH_S * light.path_travel_m)
    assert 0.3 < fast < 0.6
    assert slow < 0.7 * fast


@pytest.mark.parametrize(("present", "expected"), [("left", 1), ("rear", 0), ("front", None), (None, None)])
def test_the_present_side_is_the_number_of_the_face_that_the_robot_stands_at(
    present: Face | None, expected: int | None
) -> None:
    asked = query(SCENARIO, "rear", "left", present=present)

    assert len(asked.sides) == 2
    assert asked.present_side == expected


@pytest.mark.parametrize("face", FACES)
def test_a_side_has_its_places_relative_to_an_axle_behind_the_centre(face: Face) -> None:
    (side,) = query(SCENARIO, face).sides
    estimate, box = PushEstimate(pushed_box(SCENARIO.box, face)), pushed_box(SCENARIO.box, face)
    axle = HERE @ side.frame
    centre = axle @ Pose2(x_m=estimate.axle_m, y_m=0.0, yaw_rad=0.0)
    pushed = pushed_pose(HERE, face)

    assert (centre.x_m, centre.y_m, centre.yaw_rad) == pytest.approx((pushed.x_m, pushed.y_m, pushed.yaw_rad))
    of_box, of_robot = side.footprints
    assert (of_box.length_m, of_box.width_m) == box.size_m[:2]
    for place, expected in (
        (of_box.pose, pushed),
        (of_robot.pose, robot_footprint(ROBOT, station(ROBOT, box, pushed)).pose),
        (side.stand_off, stand_off(SCENARIO, box, pushed)),
    ):
        there = axle @ place
        assert (there.x_m, there.y_m) == pytest.approx((expected.x_m, expected.y_m))


def test_a_box_is_planned_to_turn_on_more_than_its_least_radius() -> None:
    reserved = replace(SCENARIO, pushing=PushSettings(turning_reserve=1.4))

    (side,) = query(reserved, "rear").sides

    assert side.min_turning_radius_m == pytest.approx(1.4 * PushEstimate(SCENARIO.box).turning_radius_m)


@pytest.mark.parametrize("face", FACES)
def test_a_calibration_asks_for_the_way_straight_ahead_of_the_face(face: Face) -> None:
    scenario = replace(SCENARIO, pushing=PushSettings(calibration_pushes=6))
    estimate = PushEstimate(pushed_box(scenario.box, face))

    asked = calibration_query(scenario, 5, HERE, face, estimate)

    left = pushed_pose(HERE, face).inverse() @ asked.goal
    assert distance_m(asked.start, asked.goal) == pytest.approx(6 * ROBOT.pushing.calibration_push_m)
    assert (left.x_m, left.y_m) == pytest.approx((6 * ROBOT.pushing.calibration_push_m, 0.0), abs=1e-9)
    assert asked.goal.yaw_rad == pytest.approx(HERE.yaw_rad)
    assert (asked.present_side, len(asked.sides), asked.max_iterations, asked.run_in_m) == (0, 1, 1, 0.0)
    assert asked.sides[0].frame.yaw_rad == pytest.approx(TURN_RAD[face], abs=radians(1e-6))
