"""The push cycle, on a plant without physics and at every face of the box with it."""

from math import degrees

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.errors import MotionError
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.conventions import FRONT_LEGS, LEGS, FrontLeg
from legpush.scene.faces import FACES, TURN_RAD, pushed_box, pushed_pose
from legpush.scene.footprints import behind_box
from legpush.scene.names import Face
from legpush.scene.scenario import PoseDeg, Scenario
from sim_proc.control.posture import Posture
from sim_proc.control.push_cycle import Pusher, contact_point
from sim_proc.control.steps import Steps
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.control.kinematic_plant import KinematicPlant


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

    push = Pusher(steps, at_the_box.box).cycle(Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05))

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

    push = Pusher(steps, at_the_box.box).cycle(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05))

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
