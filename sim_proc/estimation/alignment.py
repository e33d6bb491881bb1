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
"""If both differ by more, four deviations, the floor is inclined as nobody knew."""
GYRO_BIAS_SD: Final = 0.0003
"""Of the bias of a gyroscope after 0.3 s at rest."""
TURNING_RAD: Final = 0.001
"""A robot that has turned by more about a horizontal axis, by the joint angles of its legs, is not at rest yet: seven
deviations of what they tell over `ENDS_STEPS`. A robot that settles on a level floor turns by less."""
ENDS_STEPS: Final = 20
"""Steps at the beginning and at the end of the standing in which the attitude by the legs is averaged."""


class Begin(NamedTuple):
    """The arrays with which `kernel.advance` begins, or goes on."""

    state: Floats
    covariance: Floats
    memory: Floats


def aligned(body: Floats, start: Pose2, still: Floats) -> tuple[Begin, Floats]:
    """Return the beginning of an estimate of a robot that stands still, and gravity in the frame of the floor, (3,).

    `body` are its numbers, `start` the pose of its trunk in the frame of all measurements, which is chosen so, and
    `still` (n, 22) what its sensors read while it stands. The attitude is that to the floor, and follows from the joint
    angles of the legs, the bias of the accelerometer from the attitude and gravity, and that of the gyroscope from its
    mean. If gravity is not where the scenario says, the accelerometer tells where it is.

    If the legs tell that the robot still turned, only what it was at the end counts, and the gyroscope has read the
    turn besides.
    """
    gyro_bias, turned = still[:, GYRO].mean(axis=0), _turned(body, still)
    if np.linalg.norm(turned[:2]) > TURNING_RAD:
        middle = still[ENDS_STEPS // 2 : -ENDS_STEPS // 2, GYRO]
        gyro_bias = middle.mean(axis=0) - turned / (layout.STEP_S * len(middle))
        still = still[-ENDS_STEPS:]
    joints = still[:, JOINTS].mean(axis=0)
    tips, com = _legs(body, joints)
    gravity, force_b = body[layout.GRAVITY : layout.GRAVITY + 3], still[:, ACCELERATION].mean(axis=0)
    rotation = _level(tips, start.yaw_rad)
    up_b, expected_b = force_b / np.linalg.norm(force_b), -rotation.T @ gravity / np.linalg.norm(gravity)
    between = np.cross(up_b, expected_b)
    known = np.linalg.norm(between) <= MOST_BETWEEN_RAD
    share = FLOOR_SD_RAD**2 / (FLOOR_SD_RAD**2 + GRAVITY_SD_RAD**2) if known else 0.0
    if not known:
        gravity = -np.linalg.norm(gravity) * (rotation @ up_b)
    quaternion = _quaternion(rotation)
    motion.turn_by.py_func(quaternion, *(share * between))
    motion.rotation_matrix.py_func(quaternion, rotation)
    tips_f = tips @ rotation.T
    height_m = body[layout.FLOOR_HEIGHT] - tips_f[:, 2].mean()
    state, memory = np.zeros(layout.N_STATE), np.zeros(layout.N_MEMORY)
    state[layout.POSITION : layout.POSITION + 3] = start.x_m, start.y_m, height_m
    state[layout.QUATERNION : layout.QUATERNION + 4] = quaternion
    state[layout.GYRO_BIAS : layout.GYRO_BIAS + 3] = gyro_bias
    bias = force_b + rotation.T @ gravity
    state[layout.ACCELERATION_BIAS : layout.ACCELERATION_BIAS + 3] = bias
    state[layout.FEET :] = (state[:3] + tips_f).ravel()
    memory[layout.JOINTS : layout.JOINTS + 12] = joints
    memory[layout.DOWN : layout.DOWN + 4] = kernel.STANDING
    memory[layout.COM : layout.COM + 3] = com
    force_sd_rad = FLOOR_SD_RAD if known else GRAVITY_SD_RAD
    deviations = np.full(layout.N_ERRORS, 1e-3)
    deviations[layout.A : layout.A + 2] = FLOOR_SD_RAD
    deviations[layout.A + 2] = 1e-4
    deviations[layout.G : layout.G + 3] = GYRO_BIAS_SD
    deviations[layout.B : layout.B + 3] = force_sd_rad * np.linalg.norm(gravity)
    return Begin(state, np.diag(deviations**2), memory), gravity


def _legs(body: Floats, joints: Floats) -> tuple[Floats, Floats]:
    """Centres of the feet, (4, 3), and centre of mass, (3,), at joint angles (12,), in the frame of the trunk."""
    tips, com = np.empty((4, 3)), np.empty(3)
    motion.kinematics.py_func(body, joints, tips, com)
    return tips, com


def _turned(body: Floats, still: Floats) -> Floats:
    """How far the trunk turned by the legs, about its own axes, from the first to the last `ENDS_STEPS` readings."""
    ends = still[:ENDS_STEPS], still[-ENDS_STEPS:]
    first, last = (_legs(body, rows[:, JOINTS].mean(axis=0))[0] for rows in ends)
    turn = _level(first, 0.0).T @ _level(last, 0.0)
    (x, y), (to_x, to_y) = ((tips - tips.mean(axis=0))[:, :2].T for tips in (first, last))
    feet_rad = (x * to_y - y * to_x).sum() / (x * x + y * y).sum()
    return np.array([turn[2, 1], turn[0, 2], -feet_rad])


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
