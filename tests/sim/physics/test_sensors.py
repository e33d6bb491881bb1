"""Readings of the sensors by name and by leg, against MuJoCo's own accessors."""

import numpy as np
import pytest

from legpush.arrays import Floats
from legpush.scene.conventions import LEG_JOINTS, LEGS
from legpush.scene.scenario import Scenario
from sim_proc.control.watch import Watch
from sim_proc.headless import mujoco
from sim_proc.model.world import build_model
from sim_proc.physics.sensors import Sensors


def test_columns_hold_what_mujoco_calls_by_the_same_name(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    data, sensors = mujoco.MjData(model), Sensors(model)
    data.sensordata[:] = np.random.default_rng(0).normal(size=model.nsensordata)
    readings = np.stack([data.sensordata, 2 * data.sensordata])[None]
    steps = sensors.steps(readings)
    for leg, name in enumerate(LEGS):
        np.testing.assert_array_equal(steps.tips_m[0, 0, leg], data.sensor(f"{name}_tip").data)
        np.testing.assert_array_equal(steps.floor_forces_n[0, 1, leg], -2 * data.sensor(f"{name}_floor_force").data)
        np.testing.assert_array_equal(steps.box_forces_n[0, 0, leg], -data.sensor(f"{name}_box_force").data)
    for index, joint in enumerate(LEG_JOINTS):
        for values, what in (
            (steps.joint_positions_rad, "position"),
            (steps.joint_velocities_rad_s, "velocity"),
            (steps.joint_torques_n_m, "torque"),
        ):
            assert values[0, 0, index] == data.sensor(f"{joint}_{what}").data[0]
    np.testing.assert_array_equal(steps.com_m[0, 0], data.sensor("com").data)
    np.testing.assert_array_equal(steps.com_velocity_m_s[0, 0], data.sensor("com_velocity").data)


def hardest_n(forces_n: Floats) -> Floats:
    """What is felt of the forces of the feet: all of it."""
    hardest: Floats = np.linalg.norm(forces_n.mean(axis=1), axis=-1).max(axis=-1)
    return hardest


@pytest.mark.parametrize(
    ("force_n", "pressed_tick", "expected", "n_learnt"),
    [(0.0, 1, 1, 2), (29.0, 1, 1, 2), (31.0, 1, None, 0), (31.0, 2, 1, 2)],
)
def test_a_foot_that_presses_hard_raises_no_alarm_and_teaches_nothing(
    at_the_box: Scenario, force_n: float, pressed_tick: int, expected: int | None, n_learnt: int
) -> None:
    sensors = Sensors(build_model(at_the_box))
    readings = np.zeros((3, 10, max(columns.stop for columns in sensors.of.values())))
    readings[1:, :, sensors.of["com"].start] = 1.0
    readings[pressed_tick, :, sensors.of["FR_box_force"].start] = force_n
    watch = Watch(np.zeros((3, 2)), 0.2, np.zeros(2), 0.06)
    watch.pressing_n = 30.0
    assert sensors.alarm(watch, readings, hardest_n) == expected
    assert len(watch.deviations_m) == n_learnt
