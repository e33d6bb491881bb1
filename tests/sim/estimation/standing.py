"""A robot that stands still, and what its sensors read then."""

import numpy as np
from scipy.spatial.transform import Rotation

from legpush.arrays import Floats
from legpush.scene.robot import RobotSpec
from sim_proc.estimation.body import body_numbers
from sim_proc.estimation.readings import ACCELERATION, FORCES, GYRO, JOINTS, N_READINGS
from sim_proc.kinematics.leg import LegKinematics

ROBOT = RobotSpec()
GRAVITY = np.array([0.0, 0.0, -9.81])
LEVEL = Rotation.identity()


def body(gravity: Floats = GRAVITY) -> Floats:
    """The numbers of the robot, with legs that weigh nothing."""
    return body_numbers(ROBOT, gravity, np.array([30.0, 0.0, 0.0, 0.0]), np.zeros((12, 4)))


def still(n: int = 150, gravity: Floats = GRAVITY, attitude: Rotation = LEVEL) -> Floats:
    """Readings of n steps, (n, 22). The trunk is turned by `attitude`, and its feet stand on the floor."""
    row, legs = np.zeros(N_READINGS), LegKinematics(ROBOT)
    tips = np.zeros((4, 3))
    tips[:, :2] = ROBOT.stance.foot_rectangle_b()
    tips[:, 2] = -ROBOT.stance.com_height_m
    row[JOINTS] = legs.inverse(attitude.inv().apply(tips) - legs.hips_b, np.array([1.0, -1.0, 1.0, -1.0])).ravel()
    row[ACCELERATION] = attitude.inv().apply(-gravity)
    row[FORCES] = -75.0
    assert (row[GYRO] == 0.0).all()
    return np.tile(row, (n, 1))
