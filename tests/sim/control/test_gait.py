"""The crawl on a plant without physics: it goes where its path goes."""

from math import pi

import numpy as np
import pytest

from legpush.errors import MotionError
from legpush.geometry import Pose2
from legpush.scene.scenario import Box, PoseDeg
from sim_proc.control.gait import PathWalk, swing_to
from sim_proc.control.posture import Posture
from sim_proc.control.step import rest
from sim_proc.control.steps import Steps
from tests.robots import ROBOT
from tests.sim.control.kinematic_plant import KinematicPlant

START = Pose2(x_m=2.0, y_m=5.0, yaw_rad=0.0)
FAR_BOX = Box(pose=PoseDeg(x_m=9.0, y_m=9.0, yaw_deg=0.0))


def around_a_corner() -> list[Pose2]:
    """1 m ahead, then a quarter circle to the left of radius 0.8 m."""
    straight = [Pose2(x_m=2.0 + s, y_m=5.0, yaw_rad=0.0) for s in np.linspace(0.0, 1.0, 20).tolist()]
    arc = [
        Pose2(x_m=3.0 + 0.8 * np.sin(a), y_m=5.8 - 0.8 * np.cos(a), yaw_rad=a)
        for a in np.linspace(0.05, pi / 2, 30).tolist()
    ]
    return straight + arc


def test_a_plant_without_physics_is_walked_along_a_path_to_its_end() -> None:
    plant = KinematicPlant(START, FAR_BOX)
    steps = Steps(Posture(plant))
    path = around_a_corner()
    walk = PathWalk(steps, path)
    logs = []
    while not walk.progress().done:
        logs += walk.cycle()
        assert len(logs) < 100

    end = plant.trunk_pose()
    np.testing.assert_allclose([*end.xy(), end.yaw_rad], [*path[-1].xy(), path[-1].yaw_rad], atol=0.01)
    np.testing.assert_allclose(plant.tips_m()[:, :2], path[-1].apply(ROBOT.stance.foot_rectangle_b()), atol=0.01)
    n_cycles = (len(logs) - 1) // 4
    assert n_cycles >= 4
    assert steps.n_footsteps == 4 * n_cycles
    assert sum(len(log.ctrl) for log in logs) == plant.n_ticks


def test_three_feet_stand_at_every_tick_and_each_leg_swings_once_a_cycle() -> None:
    plant = KinematicPlant(START, FAR_BOX)
    walk = PathWalk(Steps(Posture(plant)), around_a_corner())
    logs = walk.cycle()
    loaded = np.concatenate([log.floor_forces_n for log in logs])[:, :, 2] > 0.0
    assert set(loaded.sum(axis=1).tolist()) == {3, 4}
    lifted = np.diff(loaded.astype(int), axis=0) == -1
    assert lifted.sum(axis=0).tolist() == [1, 1, 1, 1]


def test_a_walk_stops_early_when_the_robot_falls() -> None:
    plant = KinematicPlant(START, FAR_BOX, falls_at_tick=40)
    walk = PathWalk(Steps(Posture(plant)), around_a_corner())
    logs = walk.cycle()
    assert plant.fallen
    assert sum(len(log.ctrl) for log in logs) == 40
    assert walk.progress().travelled_m == 0.0


def test_a_path_that_begins_too_far_away_or_turned_too_much_is_refused() -> None:
    steps = Steps(Posture(KinematicPlant(START, FAR_BOX)))
    with pytest.raises(
        MotionError, match=r"path that begins at most 0\.35 m and 45° from the trunk, got 0\.40 m and 0°"
    ):
        PathWalk(steps, [START @ Pose2(x_m=0.4, y_m=0.0, yaw_rad=0.0)])
    with pytest.raises(MotionError, match=r"got 0\.00 m and 60°"):
        PathWalk(steps, [START @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=pi / 3)])


def test_a_path_that_begins_beside_the_robot_is_led_to_with_feet_apart() -> None:
    """Steps to the first place of the path at once would put the front right foot where the left one stands."""
    plant = KinematicPlant(START, FAR_BOX)
    begin = START @ Pose2(x_m=0.0, y_m=0.3, yaw_rad=0.5)
    walk = PathWalk(Steps(Posture(plant)), [begin, begin @ Pose2(x_m=0.5, y_m=0.0, yaw_rad=0.0)])
    assert walk.progress().travelled_m == 0.0
    assert walk.progress().length_m == pytest.approx(0.5)
    travelled = [0.0]
    while not walk.progress().done:
        for log in walk.cycle():
            feet = log.tips_m[-1, :, :2]
            assert min(np.linalg.norm(feet[left] - feet[left + 1]) for left in (0, 2)) > 0.15
        travelled.append(walk.progress().travelled_m)
    assert travelled == sorted(travelled)
    assert travelled[-1] == pytest.approx(0.5)
    end = begin @ Pose2(x_m=0.5, y_m=0.0, yaw_rad=0.0)
    np.testing.assert_allclose(plant.tips_m()[:, :2], end.apply(ROBOT.stance.foot_rectangle_b()), atol=0.01)


def test_a_swing_rises_by_the_step_height_and_presses_the_foot_into_the_floor() -> None:
    curve = swing_to(ROBOT, np.array([0.4, 0.1]), 40)(np.array([0.0, 0.0, ROBOT.legs.foot_radius_m]))
    np.testing.assert_allclose(curve[-1], [0.4, 0.1, ROBOT.touchdown_m])
    assert curve[:, 2].max() == pytest.approx(ROBOT.legs.foot_radius_m + ROBOT.gait.step_height_m, abs=0.001)
    assert ROBOT.touchdown_m < ROBOT.legs.foot_radius_m


def test_a_rest_moves_no_leg() -> None:
    step = rest(ROBOT.gait, np.array([1.0, 2.0]), 0.5)
    assert step.leg is None
    assert step.n_ticks == 24
    np.testing.assert_array_equal(step.end_velocity_m_s, np.zeros(2))
