"""How trunk, legs and feet move: rotations, kinematics, and what imu and joints tell of a tick. Compiled."""

from math import cos, sin, sqrt
from typing import Any

from sim_proc.estimation.compiled import compiled
from sim_proc.estimation.layout import (
    ACCELERATION_BIAS,
    FEET,
    GYRO_BIAS,
    HIPS,
    JOINTS,
    LINKS,
    LOWER,
    MASS,
    MOMENT,
    OFFSETS,
    POSITION,
    QUATERNION,
    STEP_S,
    STEPS,
    TICK_S,
    UPPER,
    VELOCITY,
)


@compiled()
def rotation_matrix(q: Any, r: Any) -> None:
    """Fill in the matrix `r` (3, 3) of a unit quaternion (w, x, y, z)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    r[0, 0], r[0, 1], r[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    r[1, 0], r[1, 1], r[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    r[2, 0], r[2, 1], r[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@compiled()
def turn_by(q: Any, x: float, y: float, z: float) -> None:
    """Turn a unit quaternion by a small rotation vector in its own frame, and make it a unit one again.

    Series of sine and cosine up to the eighth power: exact to the last digits up to 0.1 rad.
    """
    h2 = 0.25 * (x * x + y * y + z * z)
    c = 1.0 - h2 / 2 * (1.0 - h2 / 12 * (1.0 - h2 / 30 * (1.0 - h2 / 56)))
    s = 0.5 * (1.0 - h2 / 6 * (1.0 - h2 / 20 * (1.0 - h2 / 42)))
    bx, by, bz = s * x, s * y, s * z
    w0, x0, y0, z0 = q[0], q[1], q[2], q[3]
    w1 = w0 * c - x0 * bx - y0 * by - z0 * bz
    x1 = w0 * bx + x0 * c + y0 * bz - z0 * by
    y1 = w0 * by - x0 * bz + y0 * c + z0 * bx
    z1 = w0 * bz + x0 * by - y0 * bx + z0 * c
    norm = sqrt(w1 * w1 + x1 * x1 + y1 * y1 + z1 * z1)
    q[0], q[1], q[2], q[3] = w1 / norm, x1 / norm, y1 / norm, z1 / norm


@compiled()
def kinematics(body: Any, joints: Any, tips: Any, com: Any) -> None:
    """Fill in the centres of the feet, (4, 3), and the centre of mass of the robot, (3,), in the frame of the trunk."""
    m0, m1, m2 = body[MOMENT], body[MOMENT + 1], body[MOMENT + 2]
    for leg in range(4):
        q1, q2 = joints[3 * leg], joints[3 * leg + 1]
        q23 = q2 - joints[3 * leg + 2]
        c1, s1, c2, s2, c3, s3 = cos(q1), sin(q1), cos(q2), sin(q2), cos(q23), sin(q23)
        side, upper, lower = body[OFFSETS + leg], body[UPPER], body[LOWER]
        # In the frame of the hip, which turns about x: places of knee and tip, and the moments of the three links.
        knee_x, knee_z = -upper * s2, -upper * c2
        a, b, c = LINKS + 12 * leg, LINKS + 12 * leg + 4, LINKS + 12 * leg + 8
        x = body[a + 1] + (body[b + 1] * c2 + body[b + 3] * s2)
        y = body[a + 2] + (body[b] * side + body[b + 2])
        z = body[a + 3] + (body[b + 3] * c2 - body[b + 1] * s2)
        x += body[c] * knee_x + (body[c + 1] * c3 + body[c + 3] * s3)
        y += body[c] * side + body[c + 2]
        z += body[c] * knee_z + (body[c + 3] * c3 - body[c + 1] * s3)
        mass = body[a] + body[b] + body[c]
        hx, hy, hz = body[HIPS + 3 * leg], body[HIPS + 3 * leg + 1], body[HIPS + 3 * leg + 2]
        m0 += mass * hx + x
        m1 += mass * hy + (c1 * y - s1 * z)
        m2 += mass * hz + (s1 * y + c1 * z)
        tx, tz = knee_x - lower * s3, knee_z - lower * c3
        tips[leg, 0], tips[leg, 1], tips[leg, 2] = hx + tx, hy + c1 * side - s1 * tz, hz + s1 * side + c1 * tz
    com[0], com[1], com[2] = m0 / body[MASS], m1 / body[MASS], m2 / body[MASS]


@compiled()
def propagate(state: Any, gravity: Any, readings: Any, means: Any, r: Any) -> None:
    """Move position, velocity and attitude on over the steps of a tick, by gyroscope and accelerometer.

    A sample of either has what happened since the one before: the turn, and the change of velocity. `means` gets the
    specific force and the angular velocity over the tick, (6,), and `r` the attitude at its end.
    """
    q = state[QUATERNION : QUATERNION + 4]
    means[:] = 0.0
    for step in range(STEPS):
        wx, wy, wz = (
            readings[step, 0] - state[GYRO_BIAS],
            readings[step, 1] - state[GYRO_BIAS + 1],
            readings[step, 2] - state[GYRO_BIAS + 2],
        )
        turn_by(q, wx * STEP_S, wy * STEP_S, wz * STEP_S)
        rotation_matrix(q, r)
        ax, ay, az = (
            readings[step, 3] - state[ACCELERATION_BIAS],
            readings[step, 4] - state[ACCELERATION_BIAS + 1],
            readings[step, 5] - state[ACCELERATION_BIAS + 2],
        )
        for i, mean in enumerate((ax, ay, az, wx, wy, wz)):
            means[i] += mean / STEPS
        for i in range(3):
            acceleration = r[i, 0] * ax + r[i, 1] * ay + r[i, 2] * az + gravity[i]
            state[VELOCITY + i] += acceleration * STEP_S
            state[POSITION + i] += state[VELOCITY + i] * STEP_S


@compiled()
def roll(state: Any, memory: Any, r: Any, means: Any, joints: Any, leg: int, radius: float) -> None:
    """Move a standing foot on by how far it rolled in a tick: its shank turned about the contact below its centre."""
    c1, s1 = cos(joints[3 * leg]), sin(joints[3 * leg])
    about_x = joints[3 * leg] - memory[JOINTS + 3 * leg]
    about_y = joints[3 * leg + 1] - memory[JOINTS + 3 * leg + 1]
    about_y -= joints[3 * leg + 2] - memory[JOINTS + 3 * leg + 2]
    x, y, z = means[3] * TICK_S + about_x, means[4] * TICK_S + c1 * about_y, means[5] * TICK_S + s1 * about_y
    turned_x = r[0, 0] * x + r[0, 1] * y + r[0, 2] * z
    turned_y = r[1, 0] * x + r[1, 1] * y + r[1, 2] * z
    state[FEET + 3 * leg] += turned_y * radius
    state[FEET + 3 * leg + 1] -= turned_x * radius
