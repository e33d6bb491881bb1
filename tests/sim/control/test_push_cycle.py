"""The push cycle, on a plant without physics and at every face of the box with it."""

from math import degrees
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush.bounds import MAX_DEPTH_M
from legpush.errors import MotionError
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Outcome, Push, Reset, Walk
from legpush.scene.conventions import BOX_QPOS, CONTROL_PERIOD_S, FRONT_LEGS, LEGS, FrontLeg
from legpush.scene.faces import FACES, TURN_RAD, pushed_box, pushed_pose
from legpush.scene.footprints import behind_box
from legpush.scene.names import BoxShape, Face
from legpush.scene.pushing.bounds import contact_height_m
from legpush.scene.scenario import PoseDeg, Scenario
from sim_proc.control.posture import Posture
from sim_proc.control.push_cycle import Pusher, contact_point
from sim_proc.control.steps import Steps
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.conftest import standing_at_the_box
from tests.sim.control.kinematic_plant import KinematicPlant

TIPPED_DEG = 15.0
LARGEST_BOX_SPEED_M_S = 1.6
"""A foot on the deepest curve moves as fast; a box that is thrown would be faster."""


def behind(scenario: Scenario, face: Face) -> Scenario:
    """The robot at the station of a face."""
    pose = pushed_pose(scenario.box.pose.pose(), face)
    place = behind_box(pushed_box(scenario.box, face), pose, ROBOT.station_m)
    start = PoseDeg(x_m=place.x_m, y_m=place.y_m, yaw_deg=degrees(place.yaw_rad))
    return replace(scenario, start=start)


@pytest.mark.parametrize("leg", FRONT_LEGS)
def test_a_plant_without_physics_pushes_the_box_by_the_depth_and_follows_it(
    at_the_box: Scenario, leg: FrontLeg
) -> None:
    plant = KinematicPlant(at_the_box.start.pose(), at_the_box.box)
    steps = Steps(Posture(plant))

    push = Pusher(steps, at_the_box.box).cycle(Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05), (0.5, 0.5))

    assert plant.box_pose().x_m - at_the_box.box.pose.x_m == pytest.approx(0.05, abs=1e-3)
    assert push.peak_force_n == 1.0
    touched = np.concatenate([log.box_forces_n for log in push.logs]).any(axis=(0, 2))
    assert [LEGS[index] for index in np.flatnonzero(touched)] == [leg]
    station = behind_box(at_the_box.box, plant.box_pose(), ROBOT.station_m)
    np.testing.assert_allclose(plant.tips_m()[:, :2], station.apply(ROBOT.stance.foot_rectangle_b()), atol=0.005)
    assert steps.n_footsteps == 4


def test_a_push_stops_early_when_the_robot_falls(at_the_box: Scenario) -> None:
    plant = KinematicPlant(at_the_box.start.pose(), at_the_box.box, falls_at_tick=90)
    steps = Steps(Posture(plant))

    push = Pusher(steps, at_the_box.box).cycle(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05), (0.5, 0.5))

    assert sum(len(log.ctrl) for log in push.logs) == 90
    assert len(push.logs) == 3


@pytest.mark.parametrize("leg", FRONT_LEGS)
def test_the_contact_point_of_a_round_box_lies_on_its_circle(at_the_box: Scenario, leg: FrontLeg) -> None:
    box = replace(at_the_box.box, shape="cylinder", size_m=(0.4, 0.4, 0.3))
    x, y, z = contact_point(ROBOT, box, Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), "rear", leg, 0.0)
    assert np.hypot(x + ROBOT.legs.foot_radius_m, y) == pytest.approx(0.2)
    assert np.sign(y) == (1 if leg == "FL" else -1)
    assert z == pytest.approx(0.15)


@pytest.mark.parametrize("face", FACES)
def test_a_push_moves_the_box_away_from_the_face_and_the_robot_follows(at_the_box: Scenario, face: Face) -> None:
    simulator = Simulator()
    before = simulator.perform(Reset(scenario=behind(at_the_box, face), seed=0), with_trace=False)
    push = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05, face=face)

    after = simulator.perform(push, with_trace=True)

    moved = pushed_pose(planar_pose(before.world.box), face).inverse() @ pushed_pose(planar_pose(after.world.box), face)
    assert 0.03 < moved.x_m < 0.045
    assert -6.0 < degrees(moved.yaw_rad) < -1.5
    pose = pushed_pose(planar_pose(after.world.box), face)
    station = behind_box(pushed_box(at_the_box.box, face), pose, ROBOT.station_m)
    trunk = planar_pose(after.world.trunk)
    # At the end of the cycle the weight is still over the three feet that stood last.
    assert abs(trunk.x_m - station.x_m) < 0.035
    assert abs(trunk.y_m - station.y_m) < 0.035
    assert abs(wrap_angle(trunk.yaw_rad - station.yaw_rad)) < 0.02


def test_the_turned_frame_heads_away_from_its_face(at_the_box: Scenario) -> None:
    box = at_the_box.box.pose.pose()
    for face in FACES:
        assert wrap_angle(pushed_pose(box, face).yaw_rad - box.yaw_rad - TURN_RAD[face]) == pytest.approx(0.0)
    assert pushed_box(at_the_box.box, "left").size_m == (0.5, 0.4, 0.4)
    assert pushed_box(at_the_box.box, "front") == at_the_box.box


def test_a_face_that_is_not_whole_is_refused(at_the_box: Scenario) -> None:
    wedge = replace(at_the_box, box=replace(at_the_box.box, shape="wedge"))
    simulator = Simulator()
    simulator.perform(Reset(scenario=wedge, seed=0), with_trace=False)

    with pytest.raises(MotionError, match=r"a face that a wedge can be pushed at \(rear\), got front"):
        simulator.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05, face="front"), with_trace=False)


def box_speeds_m_s(outcome: Outcome) -> np.ndarray:
    """Speeds of a box that stands, at the ticks of a motion. One that tips is as fast as it falls."""
    assert outcome.trace is not None
    box = np.array(outcome.trace.qpos)[:, BOX_QPOS]
    stands = 1.0 - 2.0 * (box[1:, 4] ** 2 + box[1:, 5] ** 2) > np.cos(np.radians(TIPPED_DEG))
    speeds: np.ndarray = np.linalg.norm(np.diff(box[:, :3], axis=0), axis=1) / CONTROL_PERIOD_S
    return speeds[: len(stands) if stands.all() else int(stands.argmin())]


def tilt_deg(outcome: Outcome) -> float:
    """Angle between the upward axis of the box and the normal of the floor."""
    _, x, y, _ = outcome.world.box.orientation_wxyz
    return degrees(np.arccos(1.0 - 2.0 * (x * x + y * y)))


@given(
    shape=st.sampled_from(["cuboid", "cylinder", "wedge", "l_shape"]),
    size_m=st.tuples(st.floats(0.1, 1.2), st.floats(0.1, 1.5), st.floats(0.1, 1.6)),
    numbers=st.tuples(st.floats(0.1, 30.0), st.floats(0.1, 1.2), st.floats(0.2, 1.2)),
    away=st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-10.0, 10.0)),
    push=st.builds(
        Push,
        w1=st.floats(0.0, 1.0),
        w2=st.floats(0.0, 1.0),
        leg=st.sampled_from(FRONT_LEGS),
        depth_m=st.floats(0.0, MAX_DEPTH_M),
        locus=st.sampled_from(["swing", "published"]),
    ),
)
@settings(max_examples=25, deadline=None, database=None)
def test_every_push_is_refused_before_anything_moves_or_done_without_throwing_the_box(
    shape: BoxShape,
    size_m: tuple[float, float, float],
    numbers: tuple[float, float, float],
    away: tuple[float, float, float],
    push: Push,
) -> None:
    size_m = (size_m[0], size_m[0], size_m[2]) if shape == "cylinder" else size_m
    scenario, (mass_kg, friction, foot_friction) = standing_at_the_box(), numbers
    box = replace(
        scenario.box, shape=shape, size_m=size_m, mass_kg=mass_kg, friction=friction, foot_friction=foot_friction
    )
    scenario = behind(replace(scenario, box=box), "rear")
    start, (x_m, y_m, yaw_deg) = scenario.start, away
    start = replace(start, x_m=start.x_m + x_m, y_m=start.y_m + y_m, yaw_deg=start.yaw_deg + yaw_deg)
    simulator, twin = Simulator(), Simulator()
    try:
        before = simulator.perform(Reset(scenario=replace(scenario, start=start), seed=0), with_trace=False)
    except MotionError:
        return  # the robot would stand in the box
    twin.perform(Reset(scenario=replace(scenario, start=start), seed=0), with_trace=False)
    try:
        after = simulator.perform(push, with_trace=True)
    except MotionError:
        trunk = planar_pose(before.world.trunk)
        follow = Follow(waypoints=(trunk, trunk @ Pose2(x_m=-0.2, y_m=0.0, yaw_rad=0.0)))
        assert simulator.perform(follow, with_trace=False).state_crc == before.state_crc
        assert twin.perform(follow, with_trace=False).state_crc == before.state_crc
        # A refused push leaves no trace in what follows.
        walks = [each.perform(Walk(), with_trace=False).state_crc for each in (simulator, twin)]
        assert walks[0] == walks[1]
    else:
        assert box_speeds_m_s(after).max(initial=0.0) < LARGEST_BOX_SPEED_M_S


TALL = ((0.3, 0.3, 0.8), (0.3, 0.3, 1.2), (0.2, 0.5, 0.8))


@pytest.mark.parametrize("size_m", TALL)
@pytest.mark.parametrize(("mass_kg", "friction"), [(0.5, 0.8), (2.0, 0.5), (10.0, 0.3)])
def test_a_tall_box_is_pushed_and_neither_thrown_nor_tipped(
    at_the_box: Scenario, size_m: tuple[float, float, float], mass_kg: float, friction: float
) -> None:
    box = replace(at_the_box.box, size_m=size_m, mass_kg=mass_kg, friction=friction)
    simulator = Simulator()
    simulator.perform(Reset(scenario=behind(replace(at_the_box, box=box), "rear"), seed=0), with_trace=False)
    for leg in FRONT_LEGS:
        outcome = simulator.perform(Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05), with_trace=True)
        assert box_speeds_m_s(outcome).max() < 0.5
        assert tilt_deg(outcome) < 2.0
    assert outcome.world.box.position_m[0] > box.pose.x_m + 0.03


@pytest.mark.parametrize(("height_m", "nearer_m", "refused"), [(0.6, 0.04, False), (0.6, 0.1, True), (0.3, 0.1, False)])
def test_a_robot_whose_trunk_would_be_in_the_box_does_not_push(
    at_the_box: Scenario, height_m: float, nearer_m: float, refused: bool
) -> None:
    box = replace(at_the_box.box, size_m=(0.4, 0.5, height_m))
    scenario = behind(replace(at_the_box, box=box), "rear")
    simulator = Simulator()
    simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)
    assert simulator.episode is not None
    simulator.episode.physics.data.qpos[BOX_QPOS.start] -= nearer_m
    push = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.02)
    if refused:
        with pytest.raises(MotionError, match=r"a face at least 0\.36 m ahead of the middle of the trunk, .* 0\.6 m"):
            simulator.perform(push, with_trace=False)
    else:
        assert not simulator.perform(push, with_trace=False).world.fallen


def test_a_push_whose_contact_point_is_too_far_to_the_side_is_refused_with_what_was_expected(
    at_the_box: Scenario,
) -> None:
    wide = replace(at_the_box, box=replace(at_the_box.box, size_m=(0.4, 4.0, 0.4)))
    simulator = Simulator()
    simulator.perform(Reset(scenario=wide, seed=0), with_trace=False)
    with pytest.raises(MotionError, match=r"the curve of a push that the leg follows to 0\.02 m, .* got 0\.\d+ m"):
        simulator.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05), with_trace=False)


@pytest.mark.parametrize(
    ("changes", "face", "height_m"),
    [
        ({}, "rear", 0.2),
        ({"size_m": (0.4, 0.5, 1.6)}, "rear", ROBOT.pushing.reach_height_share * ROBOT.stance.height_m),
        ({"friction": 1.0}, "rear", 0.8 * 0.2),
        ({"friction": 1.0, "foot_friction": 0.1}, "rear", 0.8 * 0.2),
        ({"friction": 1.0}, "left", 0.8 * 0.25),
        ({"friction": 1.0, "com_offset_m": (0.1, 0.0, 0.0)}, "rear", 0.8 * 0.1),
        ({"friction": 1.0, "com_offset_m": (0.1, 0.0, 0.0)}, "front", 0.8 * 0.3),
        ({"friction": 1.0, "com_offset_m": (0.0, 0.15, 0.0)}, "right", 0.8 * 0.1),
        ({"friction": 2.0, "com_offset_m": (0.0, 0.15, 0.0)}, "left", 0.8 * 0.2),
        ({"friction": 2.0, "shape": "wedge"}, "rear", 0.8 * 0.4 / 3),
        ({"friction": 10.0}, "rear", 2 * ROBOT.legs.foot_radius_m),
    ],
)
def test_the_contact_is_below_the_height_that_tips_the_box_and_within_reach(
    at_the_box: Scenario, changes: dict[str, Any], face: Face, height_m: float
) -> None:
    highest_m = ROBOT.pushing.reach_height_share * ROBOT.stance.height_m
    box = replace(at_the_box.box, **changes)
    assert contact_height_m(ROBOT, box, face) == pytest.approx(min(height_m, 0.5 * box.size_m[2], highest_m))
