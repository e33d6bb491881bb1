"""A walk around the box begins at the robot, ends at the station, and stays away from the box."""

from itertools import pairwise
from math import degrees, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import Point, box

from agent_proc.studies.cell_parts import new_simulator
from agent_proc.walking.around_box import can_push, walk_to_face, way_around
from legpush.geometry import Pose2, distance_m, wrap_angle
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Follow, Motion, Outcome, Reset, Walk
from legpush.scenarios.file import load_scenario
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.station import at_station, station

SCENARIO = load_scenario("open")
FREE_M = 0.25
"""A little more than half the width of the body."""


@given(
    begin=st.sampled_from(FACES),
    to=st.sampled_from(FACES),
    x_m=st.floats(4.0, 8.0),
    y_m=st.floats(4.0, 8.0),
    yaw_rad=st.floats(-pi, pi),
)
def test_the_way_leads_from_the_robot_to_the_station_clear_of_the_box(
    begin: Face, to: Face, x_m: float, y_m: float, yaw_rad: float
) -> None:
    pose = Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)
    robot = SCENARIO.robot
    trunk = station(robot, pushed_box(SCENARIO.box, begin), pushed_pose(pose, begin))

    way = way_around(SCENARIO, trunk, pose, to)

    assert way[0] == trunk
    assert at_station(robot, way[-1], pushed_box(SCENARIO.box, to), pushed_pose(pose, to))
    length_m, width_m, _ = SCENARIO.box.size_m
    solid = affinity.rotate(box(-length_m / 2, -width_m / 2, length_m / 2, width_m / 2), degrees(yaw_rad), (0, 0))
    solid = affinity.translate(solid, x_m, y_m)
    assert min(solid.distance(Point(place.x_m, place.y_m)) for place in way) > FREE_M
    turns = [abs(wrap_angle(b.yaw_rad - a.yaw_rad)) for a, b in pairwise(way) if distance_m(a, b) > 0.02]
    assert max(turns) < pi / 4


@pytest.mark.parametrize("world_name", ["map", "mujoco"])
def test_the_robot_comes_to_the_face_and_leaves_the_box_where_it_is(world_name: str) -> None:
    world = LocalWorld(new_simulator(world_name))
    outcome = world.step(Reset(scenario=SCENARIO, seed=0))
    before = outcome.world.box.position_m
    motions: list[Motion] = []

    def step(motion: Motion) -> Outcome:
        motions.append(motion)
        return world.step(motion)

    outcome = walk_to_face(step, SCENARIO, outcome, "left")

    assert can_push(outcome.world, SCENARIO, "left")
    assert isinstance(motions[0], Follow)
    assert all(isinstance(motion, Walk) for motion in motions[1:])
    assert outcome.world.box.position_m == pytest.approx(before, abs=0.01)
    assert 20.0 < outcome.world.tick * 0.02 < 23.0
    assert walk_to_face(step, SCENARIO, outcome, "left") is outcome


def test_a_walk_without_physics_takes_as_long_as_one_with_it() -> None:
    ticks = []
    for name in ("map", "mujoco"):
        world = LocalWorld(new_simulator(name))
        outcome = world.step(Reset(scenario=SCENARIO, seed=0))
        ticks.append(walk_to_face(world.step, SCENARIO, outcome, "front").world.tick)
    assert ticks[0] == pytest.approx(ticks[1], rel=0.05)
