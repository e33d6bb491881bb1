"""The commanded posture, on a plant without physics."""

import numpy as np
import pytest

from legpush.geometry import Pose2
from legpush.scene.scenario import Box, PoseDeg
from sim_proc.control.posture import Posture
from tests.robots import ROBOT
from tests.sim.control.kinematic_plant import KinematicPlant

START = Pose2(x_m=2.0, y_m=5.0, yaw_rad=0.4)
FAR_BOX = Box(pose=PoseDeg(x_m=9.0, y_m=9.0, yaw_deg=0.0))


@pytest.fixture
def posture() -> Posture:
    return Posture(KinematicPlant(START, FAR_BOX))


def test_the_posture_begins_as_the_robot_stands(posture: Posture) -> None:
    np.testing.assert_allclose([*posture.trunk_xy_m, posture.yaw_rad], [2.0, 5.0, 0.4])
    np.testing.assert_allclose(posture.feet_m[:, :2], START.apply(ROBOT.stance.foot_rectangle_b()))
    np.testing.assert_allclose(posture.feet_m[:, 2], ROBOT.legs.foot_radius_m)
    np.testing.assert_allclose(posture.com_state, [[2.0, 5.0], [0.0, 0.0], [0.0, 0.0]])


def test_the_commanded_trunk_moves_along_with_feet_that_were_measured_elsewhere(posture: Posture) -> None:
    measured = posture.feet_m.copy()
    away = Pose2(x_m=0.01, y_m=-0.02, yaw_rad=0.05)
    posture.feet_m[:, :2] = away.apply(measured[:, :2])
    posture.trunk_xy_m = away.apply(posture.trunk_xy_m[None])[0]
    posture.yaw_rad += away.yaw_rad

    posture.measure()

    np.testing.assert_allclose(posture.feet_m, measured, atol=1e-12)
    np.testing.assert_allclose([*posture.trunk_xy_m, posture.yaw_rad], [2.0, 5.0, 0.4], atol=1e-12)


def test_a_tracked_motion_brings_the_trunk_where_it_is_commanded_while_the_feet_stay(posture: Posture) -> None:
    n = 20
    share = np.linspace(0.0, 1.0, n + 1)[1:]
    trunk = posture.trunk_xy_m + share[:, None] * np.array([0.03, 0.01])
    yaw = posture.yaw_rad + 0.05 * share
    feet = np.repeat(posture.feet_m[None], n, axis=0)

    log = posture.track(trunk, yaw, feet, np.ones((n, 4)), trunk, np.zeros((n, 2)))

    moved = posture.plant.trunk_pose()
    np.testing.assert_allclose([*moved.xy(), moved.yaw_rad], [2.03, 5.01, 0.45], atol=1e-6)
    np.testing.assert_allclose(log.tips_m, feet, atol=1e-6)
    np.testing.assert_allclose(posture.joints_rad, posture.plant.joints_rad(), atol=1e-6)


def test_a_foot_out_of_reach_is_stretched_for_and_commands_stay_finite(posture: Posture) -> None:
    feet = posture.feet_m[None].copy()
    feet[0, 0, :2] += 2.0
    here = posture.trunk_xy_m[None]

    log = posture.track(here, np.array([posture.yaw_rad]), feet, np.ones((1, 4)), here, np.zeros((1, 2)))

    assert np.isfinite(log.ctrl).all()
