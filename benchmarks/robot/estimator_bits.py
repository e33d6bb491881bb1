"""A hash of what the compiled estimator makes of noisy readings."""

import zlib
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.robot import RobotSpec
from sim_proc.estimation import layout
from sim_proc.estimation.body import body_numbers
from sim_proc.estimation.estimator import Estimator
from sim_proc.estimation.readings import ACCELERATION, FORCES, GYRO, JOINTS, N_READINGS
from sim_proc.kinematics.leg import LegKinematics

N_TICKS: Final = 500
DEVIATIONS: Final = ((GYRO, 0.1), (ACCELERATION, 1.0), (JOINTS, 0.01), (FORCES, 30.0))
GRAVITY_M_S2: Final = 9.81


def estimator_crc() -> str:
    """Return the CRC-32 of an estimator after ticks with all sensors disturbed, in which feet come down and slip."""
    robot, random = RobotSpec(), np.random.default_rng(0)
    gravity = np.array([0.0, 0.0, -GRAVITY_M_S2])
    body = body_numbers(robot, gravity, np.array([20.0, 0.4, 0.0, 0.0]), np.ones((12, 4)))
    row = np.zeros(N_READINGS)
    row[JOINTS] = LegKinematics(robot).standing_joints_rad().ravel()
    row[ACCELERATION.stop - 1], row[FORCES] = GRAVITY_M_S2, -80.0
    readings: Floats = np.tile(row, (N_TICKS, layout.STEPS, 1))
    for columns, deviation in DEVIATIONS:
        readings[..., columns] += random.normal(scale=deviation, size=readings[..., columns].shape)
    lifted = random.random((N_TICKS, 4)) < 0.1
    estimator = Estimator(body, Pose2(x_m=1.0, y_m=2.0, yaw_rad=0.5), np.tile(row, (150, 1)), late_steps=11)
    estimator.advance(readings, lifted)
    return f"{zlib.crc32(estimator.as_bytes()):08x}"
