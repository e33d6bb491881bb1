"""What the robot's own sensors read."""

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.realism.reality import FELT_EXACTLY, Reality, Senses
from legpush.scenarios.file import load_scenario
from sim_proc.control.joint_commands import COMMANDS_PER_TICK
from sim_proc.control.posture import Posture
from sim_proc.estimation.readings import ACCELERATION, FORCES, GYRO, JOINTS, N_READINGS
from sim_proc.headless import mujoco
from sim_proc.model.world import build_model
from sim_proc.physics.physics import Physics
from sim_proc.physics.senses import CHUNK_TICKS, ExactSenses, OwnSenses
from sim_proc.physics.sensors import Sensors

NOISY = Senses(
    gyro_noise_rad_s=0.0035,
    gyro_bias_rad_s=0.002,
    accelerometer_noise_m_s2=0.06,
    accelerometer_bias_m_s2=0.05,
    encoder_noise_rad=0.0005,
    force_noise_n=4.0,
    force_bias_n=5.0,
    latency_s=0.02,
)


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return build_model(load_scenario("push"), Reality(senses=NOISY))


def own_senses(model: mujoco.MjModel, senses: Senses = NOISY, seed: int = 1) -> OwnSenses:
    return OwnSenses(Reality(seed=seed, senses=senses), Sensors(model), np.zeros(model.nsensordata), model.opt.gravity)


def run(senses: OwnSenses, tick: int, rows: Any) -> Any:
    """Readings of a run whose ticks have sensors (n, steps, nsensordata)."""
    senses.begin_run(tick, len(rows) + 3)
    senses.feel(0, rows.reshape(-1, rows.shape[-1]))
    senses.end_run(len(rows))
    return senses.last


def test_readings_are_the_same_however_a_motion_is_split_into_runs(model: mujoco.MjModel) -> None:
    n = 2 * CHUNK_TICKS + 10
    rows = np.random.default_rng(0).normal(size=(n, COMMANDS_PER_TICK, model.nsensordata))
    whole = run(own_senses(model), 5, rows)
    senses, parts, tick = own_senses(model), [], 0
    for n_ticks in (1, 30, 2, CHUNK_TICKS + 1, n - CHUNK_TICKS - 34):
        parts.append(run(senses, 5 + tick, rows[tick : tick + n_ticks]))
        tick += n_ticks
    assert tick == n
    assert np.concatenate(parts).tobytes() == whole.tobytes()


def test_errors_have_their_deviations_and_biases_that_stay(model: mujoco.MjModel) -> None:
    rows = np.zeros((2000, COMMANDS_PER_TICK, model.nsensordata))
    errors = run(own_senses(model), 0, rows).reshape(-1, N_READINGS)
    noise, biases = errors.std(axis=0), errors.mean(axis=0)
    for columns, deviation in ((GYRO, 0.0035), (ACCELERATION, 0.06), (JOINTS, 0.0005), (FORCES, 4.0)):
        assert noise[columns] == pytest.approx(deviation, rel=0.05)
    assert np.abs(biases[JOINTS]).max() < 0.0005 / 20
    found = np.array([run(own_senses(model, seed=seed), 0, rows[:1])[0].mean(axis=0) for seed in range(200)])
    assert found[:, GYRO].std() == pytest.approx(np.hypot(0.002, 0.0035 / np.sqrt(10)), rel=0.1)
    assert found[:, FORCES].std() == pytest.approx(np.hypot(5.0, 4.0 / np.sqrt(10)), rel=0.1)


def test_one_sensor_disturbs_no_other(model: mujoco.MjModel) -> None:
    rows = np.zeros((3, COMMANDS_PER_TICK, model.nsensordata))
    all_of_them = run(own_senses(model), 0, rows)
    for name, columns in (("gyro_noise_rad_s", GYRO), ("encoder_noise_rad", JOINTS), ("force_noise_n", FORCES)):
        fewer = run(own_senses(model, replace(NOISY, **{name: 0.0})), 0, rows)
        same = np.ones(N_READINGS, dtype=bool)
        same[columns] = False
        assert (fewer[..., same] == all_of_them[..., same]).all()
        assert (fewer[..., columns] != all_of_them[..., columns]).all()


def test_readings_come_late_and_a_tare_is_taken_off(model: mujoco.MjModel) -> None:
    sensors = Sensors(model)
    senses = own_senses(model, Senses(latency_s=0.006))
    rows = np.zeros((2, COMMANDS_PER_TICK, model.nsensordata))
    rows[..., sensors.joint_positions] = np.arange(2 * COMMANDS_PER_TICK).reshape(2, -1, 1) + 1.0
    readings = run(senses, 0, rows)
    assert readings[..., JOINTS.start].ravel().tolist() == [0.0] * 3 + [k + 1.0 for k in range(17)]
    assert (readings[..., FORCES] == 0.0).all()
    assert run(senses, 2, rows)[0, :4, JOINTS.start].tolist() == [18.0, 19.0, 20.0, 1.0]
    senses.tare_n[:] = 2.0
    senses.begin_run(4, 2)
    senses.feel(0, rows.reshape(-1, model.nsensordata))
    assert (senses.of_tick(1, rows)[:, FORCES] == -2.0).all()


def test_a_leg_that_may_stop_reads_each_step_in_time(model: mujoco.MjModel) -> None:
    class Watching:
        """A landing that notes what it reads before each step."""

        def __init__(self) -> None:
            self.read: list[float] = []

        def controls(self, tick: int, controls: Any, sensors: Any) -> Any:
            del tick
            for step, control in enumerate(controls):
                self.read += [float(sensors[step - 1, JOINTS.start])] if step else []
                yield control

    for late_s, wanted in ((0.0, list(range(1, 10))), (0.004, [0, 0, *range(1, 8)]), (0.02, [0] * 9)):
        senses, watching, of_joints = own_senses(model, Senses(latency_s=late_s)), Watching(), Sensors(model)
        senses.begin_run(0, 1)
        sensors = np.zeros((1, COMMANDS_PER_TICK, model.nsensordata))
        landing: Any = watching
        for step, control in enumerate(senses.meanwhile(landing, 0, np.zeros((COMMANDS_PER_TICK, 12)), sensors)):
            assert (control == 0.0).all()
            sensors[0, step, of_joints.joint_positions] = step + 1.0
        assert watching.read == wanted


def test_exact_senses_have_no_state_and_read_what_is(model: mujoco.MjModel) -> None:
    senses, rows = ExactSenses(Sensors(model)), np.random.default_rng(0).normal(size=(2, 10, model.nsensordata))
    senses.begin_run(0, 2)
    senses.feel(0, rows[0])
    assert (senses.of_tick(1, rows) == rows[1]).all()
    assert (senses.late_steps, senses.least_touch_n, senses.as_bytes()) == (0, 0.0, b"")


def test_a_pushing_foot_feels_its_force_with_noise_and_without_bias(model: mujoco.MjModel) -> None:
    forces = np.tile([30.0, -5.0, 2.0], (400, 1))
    felt = own_senses(model).push_forces_n(7, forces)
    np.testing.assert_allclose(felt.mean(axis=0), forces[0], atol=0.3)
    np.testing.assert_allclose(felt.std(axis=0), NOISY.force_noise_n / COMMANDS_PER_TICK**0.5, rtol=0.15)
    np.testing.assert_array_equal(own_senses(model).push_forces_n(10, forces[3:]), felt[3:])
    exact = ExactSenses(Sensors(model))
    np.testing.assert_array_equal(exact.push_forces_n(7, forces), forces)


def test_how_hard_a_foot_presses_is_felt_late_and_with_noise(model: mujoco.MjModel) -> None:
    forces = np.zeros((6, COMMANDS_PER_TICK, 4, 3))
    forces[2:, :, 1, 0] = 100.0
    exact = ExactSenses(Sensors(model)).pressing_n(7, forces)
    np.testing.assert_array_equal(exact, [0.0, 0.0, 100.0, 100.0, 100.0, 100.0])
    felt = own_senses(model, Senses(latency_s=0.03)).pressing_n(7, forces)
    np.testing.assert_allclose(felt, [0.0, 0.0, 0.0, 50.0, 100.0, 100.0])
    noisy = own_senses(model).pressing_n(7, forces) - own_senses(model, Senses(latency_s=0.02)).pressing_n(7, forces)
    assert 0.0 < np.abs(noisy).max() < 5 * NOISY.force_noise_n / COMMANDS_PER_TICK**0.5


def test_noise_that_nothing_reads_changes_no_bit_of_the_physics() -> None:
    scenario = load_scenario("push")
    found = []
    for senses in (FELT_EXACTLY, NOISY):
        start = scenario.start.pose(), scenario.box.pose.pose()
        physics = Physics(scenario, *start, Reality(senses=senses))
        log = Posture(physics).stand(4)
        found.append(log.qpos.tobytes())
    assert found[0] == found[1]
