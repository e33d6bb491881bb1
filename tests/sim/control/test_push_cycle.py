"""Pushing faces of the box other than the rear one."""

from math import degrees

import pytest
from msgspec.structs import replace

from legpush.errors import MotionError
from legpush.geometry import wrap_angle
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.faces import FACES, TURN_RAD, pushed_box, pushed_pose
from legpush.scene.footprints import behind_box
from legpush.scene.names import Face
from legpush.scene.scenario import STATION_M, PoseDeg, Scenario
from sim_proc.simulator import Simulator


def behind(scenario: Scenario, face: Face) -> Scenario:
    """The robot at the station of a face."""
    pose = pushed_pose(scenario.box.pose.pose(), face)
    place = behind_box(pushed_box(scenario.box, face), pose, STATION_M)
    start = PoseDeg(x_m=place.x_m, y_m=place.y_m, yaw_deg=degrees(place.yaw_rad))
    return replace(scenario, start=start)


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
    station = behind_box(pushed_box(at_the_box.box, face), pose, STATION_M)
    trunk = planar_pose(after.world.trunk)
    assert abs(trunk.x_m - station.x_m) < 0.03
    assert abs(trunk.y_m - station.y_m) < 0.03
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
