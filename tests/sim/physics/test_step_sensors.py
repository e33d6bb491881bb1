"""The log of physics steps has the readings of the sensors with their names."""

import numpy as np

from legpush.scene.conventions import LEG_JOINTS, LEGS
from legpush.scene.scenario import Scenario
from sim_proc.model.world import build_model
from sim_proc.physics.step_sensors import StepSensors


def test_each_reading_is_that_of_the_sensor_with_its_name(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    columns = {
        model.sensor(i).name: slice(int(adr), int(adr) + int(dim))
        for i, (adr, dim) in enumerate(zip(model.sensor_adr, model.sensor_dim, strict=True))
    }
    readings = np.random.default_rng(0).normal(size=(3, 5, model.nsensordata))
    sensors = StepSensors(columns)
    log = sensors.log(readings)
    for foot, leg in enumerate(LEGS):
        np.testing.assert_array_equal(log.tips_m[:, :, foot], readings[:, :, columns[f"{leg}_tip"]])
        np.testing.assert_array_equal(log.floor_forces_n[:, :, foot], -readings[:, :, columns[f"{leg}_floor_force"]])
        np.testing.assert_array_equal(log.box_forces_n[:, :, foot], -readings[:, :, columns[f"{leg}_box_force"]])
    np.testing.assert_array_equal(log.com_m, readings[:, :, columns["com"]])
    np.testing.assert_array_equal(log.com_velocity_m_s, readings[:, :, columns["com_velocity"]])
    joints = (log.joint_positions_rad, log.joint_velocities_rad_s, log.joint_torques_n_m)
    for what, values, again in zip(("position", "velocity", "torque"), joints, sensors.joints(readings), strict=True):
        np.testing.assert_array_equal(values, again)
        for joint, name in enumerate(LEG_JOINTS):
            np.testing.assert_array_equal(values[:, :, joint], readings[:, :, columns[f"{name}_{what}"].start])
