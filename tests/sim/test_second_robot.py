"""Robots of another size: they stand, walk and push like the default one, also beside it in one process."""

from collections.abc import Iterator
from contextlib import chdir
from itertools import pairwise, zip_longest

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush.errors import LegpushError, MessageError, MotionError
from legpush.geometry import Pose2
from legpush.messages import codec
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Motion, Outcome, Push, Reset, Walk
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from legpush.scene.station import at_station, station
from sim_proc.simulator import Simulator
from tests.legpush.test_bounds import Leaf, ends, leaves, put
from tests.robots import ROBOT, scaled_robot

WALK_M = 1.0
BOX_POSE = PoseDeg(x_m=3.0, y_m=2.0, yaw_deg=0.0)
DEPTH_M = 0.05


def before_a_box(robot: RobotSpec, scale: float) -> Scenario:
    """The robot 1 m behind its station at a box of its own scale."""
    length_m, width_m, height_m = Box(pose=BOX_POSE).size_m
    box = Box(pose=BOX_POSE, size_m=(scale * length_m, scale * width_m, scale * height_m))
    place = station(robot, box, BOX_POSE.pose())
    return Scenario(
        name="scaled",
        room=Room(size_m=(6.0, 4.0)),
        start=PoseDeg(x_m=place.x_m - WALK_M, y_m=place.y_m, yaw_deg=0.0),
        box=box,
        goal=Goal(pose=PoseDeg(x_m=4.0, y_m=2.0, yaw_deg=0.0)),
        robot=robot,
    )


def outcomes(scenario: Scenario, depth_m: float) -> Iterator[tuple[Motion, Outcome]]:
    """Walk to the station, and push three times."""
    simulator = Simulator()

    def perform(motion: Motion) -> tuple[Motion, Outcome]:
        return motion, simulator.perform(motion, with_trace=True)

    start = scenario.start.pose()
    yield perform(Reset(scenario=scenario, seed=0))
    yield perform(Follow(waypoints=(start, start @ Pose2(x_m=WALK_M, y_m=0.0, yaw_rad=0.0))))
    walked = perform(Walk())
    while not (walked[1].world.fallen or (walked[1].world.path is not None and walked[1].world.path.done)):
        yield walked
        walked = perform(Walk())
    yield walked
    for leg in (*FRONT_LEGS, FRONT_LEGS[0]):
        yield perform(Push(w1=0.5, w2=0.5, leg=leg, depth_m=depth_m))


@pytest.mark.parametrize("scale", [0.6, 0.8, 1.3])
def test_a_robot_of_another_size_stands_walks_a_metre_and_pushes_three_times(scale: float) -> None:
    robot = scaled_robot(scale)
    scenario = before_a_box(robot, scale)
    done = list(outcomes(scenario, scale * DEPTH_M))

    assert not any(outcome.world.fallen for _, outcome in done)
    heights_m = [row[2] for _, outcome in done if outcome.trace is not None for row in outcome.trace.qpos]
    assert min(heights_m) > 0.95 * robot.stance.height_m
    arrived = [outcome for motion, outcome in done if isinstance(motion, Walk)][-1]
    assert at_station(robot, planar_pose(arrived.world.trunk), scenario.box, planar_pose(arrived.world.box))
    pushes = [outcome for motion, outcome in done if isinstance(motion, Push)]
    assert [push.world.push.touched for push in pushes if push.world.push is not None] == [True, True, True]
    places_m = [planar_pose(outcome.world.box).x_m for outcome in (arrived, *pushes)]
    moved_m = [after - before for before, after in pairwise(places_m)]
    assert min(moved_m) > 0.4 * scale * DEPTH_M


PLAIN = msgspec.json.decode(msgspec.json.encode(ROBOT))
NUMBERS = tuple(leaves(PLAIN, msgspec.inspect.type_info(RobotSpec)))


@given(leaf=st.sampled_from(NUMBERS), end=st.sampled_from([0, 1]))
@settings(max_examples=15, deadline=None)
def test_a_robot_with_a_number_at_its_bound_is_refused_or_moves_or_ends_the_episode(
    leaf: Leaf, end: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    try:
        robot = codec.convert(put(PLAIN, leaf, ends(leaf.kind)[end]), RobotSpec)
    except MessageError:
        return
    scenario = before_a_box(robot, 1.0)
    ready = station(robot, scenario.box, BOX_POSE.pose())
    scenario = replace(scenario, start=PoseDeg(x_m=ready.x_m, y_m=ready.y_m, yaw_deg=0.0))
    back = Follow(waypoints=(ready, ready @ Pose2(x_m=-0.3, y_m=0.0, yaw_rad=0.0)))
    simulator = Simulator()
    for motion in (Reset(scenario=scenario, seed=0), Push(w1=0.5, w2=0.5, leg="FL", depth_m=DEPTH_M), back, Walk()):
        try:
            with chdir(tmp_path_factory.mktemp("log")):  # MuJoCo writes its warnings to a file there
                outcome = simulator.perform(motion, with_trace=True)
        except MotionError:
            continue
        except LegpushError as error:
            if "the episode cannot go on" in str(error):
                return
            raise
        assert codec.decode(codec.encode(outcome), Outcome) == outcome


def test_two_robots_in_one_process_do_not_know_of_each_other() -> None:
    small = scaled_robot(0.8)
    scenarios = (before_a_box(ROBOT, 1.0), before_a_box(small, 0.8))
    alone = [[outcome.state_crc for _, outcome in outcomes(scenario, DEPTH_M)] for scenario in scenarios]
    assert alone[0] != alone[1]
    running = [outcomes(scenario, DEPTH_M) for scenario in scenarios]
    together: list[list[int]] = [[], []]
    for turn in zip_longest(*running):
        for found, done in zip(together, turn, strict=True):
            found += [] if done is None else [done[1].state_crc]
    assert together == alone
