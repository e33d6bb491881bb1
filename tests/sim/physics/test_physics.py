"""The running world: what it measures, and what ends an episode."""

from collections.abc import Iterable
from math import radians
from pathlib import Path

import msgspec
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.errors import LegpushError
from legpush.geometry import Pose2
from legpush.messages.stepping import Reset
from legpush.scene.conventions import JOINT_QPOS
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Scenario
from sim_proc.kinematics.actuator_limits import ActuatorLimits
from sim_proc.physics.physics import Physics
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.commands import held


@pytest.fixture
def logs_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo writes its warnings to a file in the present folder."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def physics(at_the_box: Scenario) -> Physics:
    return Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())


def stand(physics: Physics, n_ticks: int) -> None:
    targets = np.repeat(physics.data.qpos[JOINT_QPOS][None], n_ticks, axis=0)
    physics.run(held(targets))


def test_the_foot_sensors_of_a_standing_robot_read_its_weight(at_the_box: Scenario) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    targets = np.repeat(physics.data.qpos[JOINT_QPOS][None], 100, axis=0)
    log = physics.run(held(targets))
    vertical = log.floor_forces_n[-1, :, 2]
    assert (vertical > 0).all()
    assert vertical.sum() == pytest.approx(physics.mass_kg * 9.81, rel=0.01)
    np.testing.assert_allclose(physics.sensor("imu_acceleration"), [0.0, 0.0, 9.81], atol=0.2)


def test_robot_and_box_begin_at_their_poses_at_rest(at_the_box: Scenario) -> None:
    trunk, box = Pose2(x_m=3.0, y_m=4.0, yaw_rad=0.4), Pose2(x_m=6.0, y_m=5.0, yaw_rad=-2.0)
    physics = Physics(at_the_box, trunk, box)
    for measured, expected in ((physics.trunk_pose(), trunk), (physics.box_pose(), box)):
        np.testing.assert_array_equal(measured.xy(), expected.xy())
        assert measured.yaw_rad == pytest.approx(expected.yaw_rad, abs=1e-4)
    assert physics.data.qpos[2] == pytest.approx(ROBOT.stance.height_m, abs=0.002)
    np.testing.assert_array_equal(physics.data.qvel, np.zeros(24))
    assert (physics.tick, physics.fallen) == (0, False)


def test_a_tick_is_20_ms_and_a_run_has_as_many_as_it_has_commands(physics: Physics) -> None:
    stand(physics, 7)
    assert physics.tick == 7
    assert physics.data.time == pytest.approx(0.14)


def test_the_crc_is_that_of_the_state(physics: Physics) -> None:
    before = physics.state_crc()
    assert physics.state_crc() == before
    physics.data.qpos[0] = np.nextafter(physics.data.qpos[0], 10.0)
    assert physics.state_crc() != before


def test_equal_states_of_other_robots_have_other_crcs_and_equal_robots_equal_ones(at_the_box: Scenario) -> None:
    def crc(robot: RobotSpec) -> int:
        scenario = replace(at_the_box, robot=robot)
        return Physics(scenario, at_the_box.start.pose(), at_the_box.box.pose.pose()).state_crc()

    gait = at_the_box.robot.gait
    as_sent = msgspec.msgpack.decode(msgspec.msgpack.encode(at_the_box.robot), type=RobotSpec)
    whole = replace(at_the_box.robot, legs=replace(at_the_box.robot.legs, foot_friction=1))
    assert crc(at_the_box.robot) == crc(as_sent) == crc(whole)
    assert crc(replace(at_the_box.robot, gait=replace(gait, stride_m=gait.stride_m / 2))) != crc(at_the_box.robot)


def test_the_angular_velocity_of_the_trunk_is_in_the_world_frame(at_the_box: Scenario) -> None:
    turned = Pose2(x_m=2.0, y_m=5.0, yaw_rad=radians(90.0))
    physics = Physics(at_the_box, turned, at_the_box.box.pose.pose())
    physics.data.qvel[3:6] = [1.0, 0.0, 0.5]
    np.testing.assert_allclose(physics.body_state().angular_velocity_rad_s, [0.0, 1.0, 0.5], atol=1e-12)


def test_a_fall_ends_a_run_early(physics: Physics) -> None:
    physics.data.qvel[2:4] = [3.0, 20.0]
    targets = np.repeat(physics.data.qpos[JOINT_QPOS][None], 100, axis=0)
    log = physics.run(held(targets))
    assert physics.fallen
    assert 0 < len(log.qpos) < 100
    assert physics.tick == len(log.qpos)


@pytest.mark.usefixtures("logs_elsewhere")
def test_a_warning_of_mujoco_ends_the_episode_with_the_ticks_in_which_it_came(physics: Physics) -> None:
    stand(physics, 3)
    physics.data.qvel[0] = 1e12
    with pytest.raises(LegpushError, match=r"MuJoCo warned of mjWARN_\w+ between ticks 3 and \d+: .* cannot go on"):
        stand(physics, 2)


@pytest.mark.usefixtures("logs_elsewhere")
def test_a_state_that_is_not_finite_ends_the_episode(physics: Physics) -> None:
    targets = np.full((1, 12), np.nan)
    with pytest.raises(LegpushError, match=r"between ticks 0 and 1: the episode cannot go on"):
        physics.run(held(targets))


def test_torques_stay_within_the_limits_at_each_angle_and_speed(physics: Physics) -> None:
    targets = np.repeat(physics.data.qpos[JOINT_QPOS][None], 10, axis=0)
    targets[:, 2] += np.linspace(0.1, 1.0, 10)
    limits = ActuatorLimits(ROBOT)
    seen: list[bool] = []
    step = physics._run_steps

    def run_steps(controls: Iterable[Floats], sensors: Floats, *, limited: bool) -> None:
        assert limited
        step(controls, sensors, limited=limited)
        columns = (sensors[:, columns] for columns in physics._joint_sensors)
        seen.append(bool(limits.beyond(*columns).any()))

    physics._run_steps = run_steps  # type: ignore[method-assign]
    physics.run(held(targets))
    assert len(seen) == 10
    assert not any(seen)


def test_an_episode_begins_in_its_places_at_rest_with_the_weight_on_the_feet(at_the_box: Scenario) -> None:
    simulator = Simulator()
    world = simulator.perform(Reset(scenario=at_the_box, seed=0), with_trace=False).world
    assert simulator.episode is not None
    physics = simulator.episode.physics
    assert (world.tick, physics.data.time) == (0, 0.0)
    assert sum(world.foot_forces_n) == pytest.approx(physics.mass_kg * 9.81, rel=0.01)
    assert min(world.foot_forces_n) > 0.2 * physics.mass_kg * 9.81
    np.testing.assert_array_equal(physics.data.qvel, 0.0)
