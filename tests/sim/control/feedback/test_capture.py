"""Capture steps, on a plant without physics and in gusts."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Push, Reset, Walk
from legpush.realism.settings import Gusts, Realism
from legpush.scene.scenario import Box, PoseDeg, Scenario
from sim_proc.control.body_state import BodyState
from sim_proc.control.feedback.capture import CaptureTrot
from sim_proc.control.posture import Posture
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.control.kinematic_plant import KinematicPlant

CAPTURE = ROBOT.capture
START = Pose2(x_m=2.0, y_m=5.0, yaw_rad=0.3)
FAR_BOX = Box(pose=PoseDeg(x_m=9.0, y_m=9.0, yaw_deg=0.0))


class Moving(KinematicPlant):
    """A plant whose trunk is measured to move, though it does not."""

    velocity_m_s = np.zeros(3)

    def body_state(self) -> BodyState:
        state = super().body_state()
        return BodyState(**{**vars(state), "velocity_m_s": self.velocity_m_s})


def landed_m(velocity_m_s: tuple[float, float], *, lifted: int) -> Floats:
    """Where the feet of a robot with a measured velocity are after one step of two feet, (4, 2), trunk frame."""
    robot = replace(ROBOT, capture=replace(CAPTURE, least_steps=2, most_steps=2, brake_share=1.0))
    plant = Moving(START, FAR_BOX, robot=robot)
    turned = Pose2(x_m=0.0, y_m=0.0, yaw_rad=START.yaw_rad).apply([velocity_m_s])[0]
    plant.velocity_m_s = np.array([*turned, 0.0])
    trot = CaptureTrot(Posture(plant))
    logs = trot.run(lifted)[: CAPTURE.step_ticks]
    assert trot.n_footsteps == 4
    return START.inverse().apply(logs[-1].tips_m[0, :, :2])


def test_a_robot_that_stands_trots_on_its_corners_for_the_least_number_of_steps() -> None:
    plant = KinematicPlant(START, FAR_BOX)
    logs = CaptureTrot(Posture(plant)).run(None)
    assert len(logs) == CAPTURE.least_steps * CAPTURE.step_ticks
    np.testing.assert_allclose(plant.tips_m()[:, :2], START.apply(ROBOT.stance.foot_rectangle_b()), atol=0.002)
    lifted = np.concatenate([log.floor_forces_n for log in logs])[:, :, 2] == 0.0
    assert not (lifted[:, [0, 3]].any(axis=1) & lifted[:, [1, 2]].any(axis=1)).any()
    assert lifted.any(axis=0).all()


def test_feet_step_ahead_of_a_moving_trunk_and_the_pair_in_the_air_goes_first() -> None:
    moved = landed_m((0.3, 0.2), lifted=1) - ROBOT.stance.foot_rectangle_b()
    assert (moved[[1, 2], 0] > 0.04).all()
    assert (moved[[1, 2], 1] > 0.025).all()
    np.testing.assert_allclose(moved[[0, 3]], 0.0, atol=0.002)


def test_feet_do_not_step_out_of_reach_or_onto_their_neighbours() -> None:
    for velocity_m_s in ((3.0, 0.0), (-3.0, 0.0), (0.0, 3.0), (0.0, -3.0)):
        feet = landed_m(velocity_m_s, lifted=0)
        assert (np.abs(feet[:, 0] - ROBOT.stance.foot_rectangle_b()[:, 0]) <= CAPTURE.forward_m + 0.03).all()
        assert (np.abs(feet[:, 1]) <= CAPTURE.outward_m + 0.03).all()
        assert (feet[[0, 2], 1] - feet[[1, 3], 1] > CAPTURE.apart_m - 0.03).all()


def in_gust(scenario: Scenario, force_n: float, at_s: float, direction_deg: float) -> Scenario:
    gusts = Gusts(force_n=force_n, duration_s=0.2, at_s=at_s, direction_deg=direction_deg)
    return replace(scenario, realism=Realism(gusts=gusts))


@pytest.mark.parametrize("direction_deg", [90.0, 225.0])
def test_a_robot_that_a_gust_throws_off_its_path_stays_up_and_walks_on_to_its_end(
    at_the_box: Scenario, direction_deg: float
) -> None:
    away = replace(at_the_box, start=PoseDeg(x_m=2.0, y_m=2.5, yaw_deg=0.0))
    simulator = Simulator()
    simulator.perform(Reset(scenario=in_gust(away, 150.0, 1.9, direction_deg), seed=0), with_trace=False)
    end = Pose2(x_m=2.8, y_m=2.5, yaw_rad=0.0)
    outcome = simulator.perform(Follow(waypoints=(Pose2(x_m=2.0, y_m=2.5, yaw_rad=0.0), end)), with_trace=False)
    travelled, aside_m = [], 0.0
    while outcome.world.path is not None and not outcome.world.path.done and not outcome.world.fallen:
        outcome = simulator.perform(Walk(), with_trace=False)
        travelled.append(outcome.world.path.travelled_m if outcome.world.path else 0.0)
        aside_m = max(aside_m, abs(planar_pose(outcome.world.trunk).y_m - 2.5))
        assert len(travelled) < 12
    assert not outcome.world.fallen
    assert aside_m > 0.1
    assert travelled[-1] == pytest.approx(0.8)
    np.testing.assert_allclose(planar_pose(outcome.world.trunk).xy(), end.xy(), atol=0.03)


def test_a_push_that_a_gust_interrupts_ends_at_the_station(at_the_box: Scenario) -> None:
    simulator = Simulator()
    simulator.perform(Reset(scenario=in_gust(at_the_box, 150.0, 0.8, 90.0), seed=0), with_trace=False)
    outcome = simulator.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05), with_trace=False)
    assert not outcome.world.fallen
    assert outcome.world.push is not None
    station = planar_pose(outcome.world.box) @ Pose2(x_m=-0.2 - ROBOT.station_m, y_m=0.0, yaw_rad=0.0)
    np.testing.assert_allclose(planar_pose(outcome.world.trunk).xy(), station.xy(), atol=0.03)
