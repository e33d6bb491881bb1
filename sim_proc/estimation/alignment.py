"""Where a robot that stands still takes itself to be: the beginning of an estimate."""

from math import cos, sin
from typing import Final, NamedTuple

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from sim_proc.estimation import kernel, layout, motion
from sim_proc.estimation.readings import ACCELERATION, GYRO, JOINTS

FLOOR_SD_RAD: Final = 0.0015
"""Standard deviation of the floor's inclination by the joint angles of four standing legs. Our choice."""
GRAVITY_SD_RAD: Final = 0.005
"""The same by the accelerometer: its bias, in shares of gravity."""
MOST_BETWEEN_RAD: Final = 0.021
"""If both differ by more, the floor is inclined as nobody knew, and gravity alone is believed: four deviations."""
GYRO_BIAS_SD: Final = 0.0003
"""Of the bias of a gyroscope after 0.3 s at rest."""


class Begin(NamedTuple):
    """The arrays with which `kernel.advance` begins."""

    state: Floats
    covariance: Floats
    memory: Floats


def aligned(body: Floats, start: Pose2, still: Floats) -> Begin:
    """Return the beginning of an estimate of a robot that stands still.

    `body` are its numbers, `start` the pose of its trunk in the frame of all measurements, which is chosen so, and
    `still` (n, 22) what its sensors read while it stands. The floor is as level as the scenario says. So the attitude
    follows from the joint angles of the legs, the bias of the accelerometer from the attitude and gravity, and that of
    the gyroscope from its mean.
    """
    joints = still[:, JOINTS].mean(axis=0)
    tips, com = np.empty((4, 3)), np.empty(3)
    motion.kinematics.py_func(body, joints, tips, com)
    gravity, force_b = body[layout.GRAVITY : layout.GRAVITY + 3], still[:, ACCELERATION].mean(axis=0)
    rotation = _level(tips, start.yaw_rad)
    up_b, expected_b = force_b / np.linalg.norm(force_b), -rotation.T @ gravity / np.linalg.norm(gravity)
    between = np.cross(up_b, expected_b)
    known = np.linalg.norm(between) <= MOST_BETWEEN_RAD
    share = FLOOR_SD_RAD**2 / (FLOOR_SD_RAD**2 + GRAVITY_SD_RAD**2) if known else 1.0
    quaternion = _quaternion(rotation)
    motion.turn_by.py_func(quaternion, *(share * between))
    motion.rotation_matrix.py_func(quaternion, rotation)
    tips_f = tips @ rotation.T
    height_m = body[layout.FLOOR_HEIGHT] - tips_f[:, 2].mean()
    state, memory = np.zeros(layout.N_STATE), np.zeros(layout.N_MEMORY)
    state[layout.POSITION : layout.POSITION + 3] = start.x_m, start.y_m, height_m
    state[layout.QUATERNION : layout.QUATERNION + 4] = quaternion
    state[layout.GYRO_BIAS : layout.GYRO_BIAS + 3] = still[:, GYRO].mean(axis=0)
    bias = force_b + rotation.T @ gravity
    state[layout.ACCELERATION_BIAS : layout.ACCELERATION_BIAS + 3] = bias
    state[layout.FEET :] = (state[:3] + tips_f).ravel()
    memory[layout.JOINTS : layout.JOINTS + 12] = joints
    memory[layout.DOWN : layout.DOWN + 4] = kernel.STANDING
    memory[layout.COM : layout.COM + 3] = com
    tilt_sd = FLOOR_SD_RAD if known else GRAVITY_SD_RAD
    deviations = np.full(layout.N_ERRORS, 1e-3)
    deviations[layout.A : layout.A + 2] = tilt_sd
    deviations[layout.A + 2] = 1e-4
    deviations[layout.G : layout.G + 3] = GYRO_BIAS_SD
    deviations[layout.B : layout.B + 3] = tilt_sd * np.linalg.norm(gravity)
    return Begin(state, np.diag(deviations**2), memory)


def _level(tips_b: Floats, yaw_rad: float) -> Floats:
    """The attitude in which four tips (4, 3), in the frame of the trunk, stand on level ground, with a heading."""
    front_left, front_right, rear_left, rear_right = tips_b
    up = np.cross(front_left - rear_right, front_right - rear_left)
    up *= np.copysign(1.0 / np.linalg.norm(up), up[2])
    forward = np.array([1.0, 0.0, 0.0]) - up[0] * up
    forward /= np.linalg.norm(forward)
    c, s = cos(yaw_rad), sin(yaw_rad)
    turned: Floats = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ [forward, np.cross(up, forward), up]
    return turned


def _quaternion(rotation: Floats) -> Floats:
    """The unit quaternion (w, x, y, z) of a rotation about an axis near the vertical."""
    r = rotation
    if r[0, 0] + r[1, 1] + r[2, 2] > 0.0:
        found = np.array([1 + r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    else:
        found = np.array([r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1 - r[0, 0] - r[1, 1] + r[2, 2]])
    unit: Floats = found / np.linalg.norm(found)
    return unit
