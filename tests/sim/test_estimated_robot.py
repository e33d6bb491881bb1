"""Episodes in which control reads estimates only."""

from math import hypot
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2, wrap_angle
from legpush.messages.stepping import Follow, Outcome, Push, Reset, Walk
from legpush.realism.profiles import REAL
from legpush.realism.settings import PoseSensor, Realism
from legpush.scene.scenario import Scenario
from sim_proc.perception import planar
from sim_proc.simulator import Simulator
from tests.sim.conftest import standing_at_the_box

SENSES = Realism(
    imu=REAL.imu, encoders=REAL.encoders, foot_forces=REAL.foot_forces, sensor_latency_s=REAL.sensor_latency_s
)


def scenario_with(scenario: Scenario, realism: Realism) -> Scenario:
    """The scenario with a realism, and its box out of the way."""
    far = replace(scenario.box, pose=replace(scenario.box.pose, x_m=10.0, y_m=8.0))
    return replace(scenario, realism=realism, box=far)


def walked(scenario: Scenario, realism: Realism, n_cycles: int = 4, seed: int = 1) -> tuple[Simulator, list[Outcome]]:
    """A walk straight ahead."""
    simulator = Simulator()
    outcomes = [simulator.perform(Reset(scenario=scenario_with(scenario, realism), seed=seed), with_trace=False)]
    path = tuple(scenario.start.pose() @ Pose2(x_m=0.1 * k, y_m=0.0, yaw_rad=0.0) for k in range(30))
    outcomes.append(simulator.perform(Follow(waypoints=path), with_trace=False))
    outcomes += [simulator.perform(Walk(), with_trace=False) for _ in range(n_cycles)]
    return simulator, outcomes


def estimated(simulator: Simulator) -> Any:
    assert simulator.episode is not None
    assert simulator.episode._estimated is not None
    return simulator.episode._estimated


@pytest.fixture(scope="module")
def walk() -> tuple[Simulator, list[Outcome]]:
    return walked(standing_at_the_box(), SENSES)


def test_the_estimate_is_near_the_truth_and_not_the_truth(walk: tuple[Simulator, list[Outcome]]) -> None:
    simulator, outcomes = walk
    robot, truth, tick = estimated(simulator), outcomes[-1].world.trunk, outcomes[-1].world.tick
    assert tick > 4 * 60
    state = robot.body_state()
    away = state.position_m - truth.position_m
    assert 0.0 < hypot(away[0], away[1]) < 0.02
    assert 0.0 < abs(away[2]) < 0.004
    assert 0.0 < np.linalg.norm(state.velocity_m_s - truth.linear_velocity_m_s) < 0.1
    assert state.tips_m - outcomes[-1].world.tips_m == pytest.approx(0.0, abs=0.025)
    assert 0.0 < np.abs(robot.joints_rad() - outcomes[-1].world.joint_positions_rad).max() < 0.15
    assert state.loads_n.sum() == pytest.approx(robot.mass_kg * 9.81, rel=0.15)
    seen = outcomes[-1].world.perceived
    assert seen is not None
    assert seen.box == outcomes[-1].world.box


def test_a_slope_that_nobody_told_is_leant_against(at_the_box: Scenario) -> None:
    simulator, outcomes = walked(at_the_box, replace(SENSES, slope_deg=10.0, uphill_deg=75.0), n_cycles=3)
    assert simulator.episode is not None
    physics, robot = simulator.episode.physics, estimated(simulator)
    assert robot.downhill == pytest.approx(physics.actual_downhill, abs=0.02)
    assert not outcomes[-1].world.fallen
    # Its weight lies uphill of the middle of its feet, so that the plumb line meets the floor between them.
    uphill_m = (physics.com_m()[:2] - physics.tips_m()[:, :2].mean(axis=0)) @ -physics.actual_downhill
    assert uphill_m / np.linalg.norm(physics.actual_downhill) > 0.04


def test_late_commands_are_noticed_in_the_first_step_and_each_foot_is_waited_for(at_the_box: Scenario) -> None:
    late = replace(SENSES, command_latency_s=0.1)
    simulator, outcomes = walked(at_the_box, late, n_cycles=3)
    robot = estimated(simulator)
    assert robot.late_ticks == 5
    assert not outcomes[-1].world.fallen
    # Four steps a cycle, none of them again, none of them a capture step.
    assert outcomes[-1].world.n_footsteps == 12
    state, truth = robot.body_state(), outcomes[-1].world.trunk
    assert np.linalg.norm(state.position_m - truth.position_m) < 0.05
    assert walked(at_the_box, late, n_cycles=3)[1][-1].state_crc == outcomes[-1].state_crc


def test_an_episode_repeats_bit_for_bit(walk: tuple[Simulator, list[Outcome]], at_the_box: Scenario) -> None:
    again = walked(at_the_box, SENSES)[1]
    assert [each.state_crc for each in again] == [each.state_crc for each in walk[1]]
    other = walked(at_the_box, SENSES, seed=2, n_cycles=1)[1]
    assert other[-1].state_crc != again[len(other) - 1].state_crc


def test_what_is_estimated_is_a_part_of_the_state(walk: tuple[Simulator, list[Outcome]]) -> None:
    simulator, outcomes = walk
    assert simulator.episode is not None
    robot = estimated(simulator)
    crcs = {outcomes[-1].state_crc}
    for array in robot._estimator._arrays:
        kept, array.flat[0] = array.flat[0], array.flat[0] + 1e-9
        crcs.add(simulator.episode.outcome([], with_trace=False).state_crc)
        array.flat[0] = kept
    assert len(crcs) == 4
    assert simulator.episode.outcome([], with_trace=False).state_crc == outcomes[-1].state_crc


def test_a_fix_moves_the_world_and_not_the_legs(at_the_box: Scenario) -> None:
    located = replace(SENSES, localization=PoseSensor(noise_m=0.05, noise_deg=2.0, rate_hz=2.0))
    simulator, outcomes = walked(at_the_box, located, n_cycles=1)
    robot = estimated(simulator)
    places, states = [robot.place_of_world()], [robot.body_state().tips_m]
    for _ in range(3):
        simulator.perform(Walk(), with_trace=False)
        places.append(robot.place_of_world())
        states.append(robot.body_state().tips_m)
    assert len({place.x_m for place in places}) == 4
    free = walked(at_the_box, replace(SENSES, localization=PoseSensor(noise_m=0.05, rate_hz=0.01)), n_cycles=1)
    # The same sensors and path: legs move apart only as the path does, with the world.
    assert estimated(free[0]).body_state().tips_m == pytest.approx(states[0], abs=0.06)
    seen = outcomes[-1].world.perceived
    assert seen is not None
    assert 0 < seen.trunk_tick < outcomes[-1].world.tick


def test_the_box_is_seen_beside_the_robot_however_far_this_has_drifted(at_the_box: Scenario) -> None:
    simulator = Simulator()
    reset = Reset(scenario=replace(at_the_box, realism=SENSES), seed=4)
    simulator.perform(reset, with_trace=False)
    simulator.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05), with_trace=False)
    assert simulator.episode is not None
    physics, robot = simulator.episode.physics, estimated(simulator)
    beside = robot.trunk_pose().inverse() @ robot.box_pose()
    truly = physics.trunk_pose().inverse() @ planar(physics.data.qpos[19:26])
    assert (beside.x_m, beside.y_m) == pytest.approx((truly.x_m, truly.y_m), abs=1e-9)
    assert wrap_angle(beside.yaw_rad - truly.yaw_rad) == pytest.approx(0.0, abs=1e-9)
    assert robot.box_pose() != physics.box_pose()


def test_a_repeated_run_is_estimated_as_if_it_had_been_run_once(
    at_the_box: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = []
    for suspicious in (False, True):
        simulator = Simulator()
        simulator.perform(Reset(scenario=scenario_with(at_the_box, SENSES), seed=1), with_trace=False)
        assert simulator.episode is not None
        if suspicious:
            monkeypatch.setattr(simulator.episode.physics.contacts, "suspects", lambda _: True)
        path = tuple(at_the_box.start.pose() @ Pose2(x_m=0.1 * k, y_m=0.0, yaw_rad=0.0) for k in range(30))
        simulator.perform(Follow(waypoints=path), with_trace=False)
        simulator.perform(Walk(), with_trace=False)
        found.append(estimated(simulator).as_bytes())
    assert found[0] == found[1]
