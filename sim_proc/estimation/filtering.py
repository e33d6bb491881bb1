"""How errors of the estimate spread, and what a foot that stands tells of them. Compiled.

After M. Bloesch et al., *State Estimation for Legged Robots: Consistent Fusion of Leg Kinematics and IMU*, RSS 2012.
Errors are those of position and velocity of the trunk, its attitude, the biases of gyroscope and accelerometer, and the
centres of the feet. An error of attitude is a rotation in the frame of the trunk.
"""

from typing import Any, Final

from sim_proc.estimation.compiled import compiled
from sim_proc.estimation.layout import (
    ACCELERATION_BIAS,
    FEET,
    GYRO_BIAS,
    N_ERRORS,
    POSITION,
    QUATERNION,
    STEP_S,
    TICK_S,
    VELOCITY,
    A,
    B,
    F,
    G,
    P,
    V,
)
from sim_proc.estimation.motion import turn_by

GYRO_VARIANCE: Final = 0.0035**2 * STEP_S * TICK_S + 1e-9
"""Of the attitude after a tick, [rad²]: the noise of a gyroscope as in the profile `real`."""
ACCELERATION_VARIANCE: Final = 0.09**2 * STEP_S * TICK_S + 1e-6
"""Of the velocity after a tick, [m²/s²]: that of an accelerometer, and a shaking trunk."""
POSITION_VARIANCE: Final = 1e-8
GYRO_BIAS_VARIANCE: Final = 1e-9
ACCELERATION_BIAS_VARIANCE: Final = 1e-6 * TICK_S
SLIP_VARIANCE: Final = 0.005**2 * TICK_S
"""How far a standing foot may creep in a tick, [m²]."""
KINEMATICS_VARIANCE: Final = 0.0015**2
"""Of the place of a foot by the joint angles, in the frame of the trunk, [m²]."""
FOOTHOLD_VARIANCE: Final = 0.004**2
"""Of the same for a foot that has just come down: it may still slip a little."""


@compiled()
def error_transition(r: Any, means: Any, f: Any) -> None:
    """Fill in what an error of position, velocity or attitude becomes in a tick, (9, 15), of the errors of those and of
    the biases. `r` is the attitude, `means` the specific force and the angular velocity in the frame of the trunk."""
    f[:, :] = 0.0
    ax, ay, az, wx, wy, wz = means[0], means[1], means[2], means[3], means[4], means[5]
    for i in range(3):
        f[P + i, P + i] = f[V + i, V + i] = f[A + i, A + i] = 1.0
        f[P + i, V + i] = TICK_S
        f[V + i, A] = -TICK_S * (r[i, 1] * az - r[i, 2] * ay)
        f[V + i, A + 1] = -TICK_S * (r[i, 2] * ax - r[i, 0] * az)
        f[V + i, A + 2] = -TICK_S * (r[i, 0] * ay - r[i, 1] * ax)
        for j in range(3):
            f[V + i, B + j] = -TICK_S * r[i, j]
        f[A + i, G + i] = -TICK_S
    f[A, A + 1], f[A, A + 2] = TICK_S * wz, -TICK_S * wy
    f[A + 1, A], f[A + 1, A + 2] = -TICK_S * wz, TICK_S * wx
    f[A + 2, A], f[A + 2, A + 1] = TICK_S * wy, -TICK_S * wx


@compiled()
def spread(covariance: Any, f: Any, work: Any, down: Any) -> None:
    """Move the covariance of the errors, (27, 27), on over a tick."""
    for i in range(G):
        for j in range(N_ERRORS):
            work[i, j] = 0.0
        for k in range(F):
            share = f[i, k]
            if share != 0.0:
                for j in range(N_ERRORS):
                    work[i, j] += share * covariance[k, j]
    for i in range(G):
        for j in range(N_ERRORS):
            covariance[i, j] = work[i, j]
    for i in range(N_ERRORS):
        for j in range(G):
            total = 0.0
            for k in range(F):
                if f[j, k] != 0.0:
                    total += covariance[i, k] * f[j, k]
            work[j, i] = total
    for i in range(N_ERRORS):
        for j in range(G):
            covariance[i, j] = work[j, i]
            covariance[j, i] = work[j, i]
    for i in range(3):
        covariance[P + i, P + i] += POSITION_VARIANCE
        covariance[V + i, V + i] += ACCELERATION_VARIANCE
        covariance[A + i, A + i] += GYRO_VARIANCE
        covariance[G + i, G + i] += GYRO_BIAS_VARIANCE
        covariance[B + i, B + i] += ACCELERATION_BIAS_VARIANCE
        for leg in range(4):
            if down[leg] != 0.0:
                covariance[F + 3 * leg + i, F + 3 * leg + i] += SLIP_VARIANCE


@compiled()
def foothold_derivative(r: Any, offset: Any, i: int, h: Any) -> None:
    """Fill in the derivative (9,) of one axis of a foot in the frame of the trunk by errors of position, attitude and
    that foot. `offset` (3,) is where the foot is from the trunk, in that frame."""
    for j in range(3):
        h[j] = -r[j, i]
        h[6 + j] = r[j, i]
        h[3 + j] = 0.0
    if i == 0:
        h[4], h[5] = -offset[2], offset[1]
    elif i == 1:
        h[3], h[5] = offset[2], -offset[0]
    else:
        h[3], h[4] = -offset[1], offset[0]


@compiled()
def lever(r: Any, tip: Any, i: int) -> tuple[float, float, float]:
    """Return the derivative of the axis `i` of the place of a foot by an error of the attitude `r`."""
    return (
        r[i, 2] * tip[1] - r[i, 1] * tip[2],
        r[i, 0] * tip[2] - r[i, 2] * tip[0],
        r[i, 1] * tip[0] - r[i, 0] * tip[1],
    )


@compiled()
def place_foot(state: Any, covariance: Any, r: Any, tip: Any, leg: int, rows: Any) -> None:
    """Let a foot stand where the joint angles say that it is, `tip` in the frame of the trunk.

    Its error is that of the trunk, and what the error of attitude does at this distance. `rows` (3, 27) is overwritten.
    """
    first = F + 3 * leg
    for i in range(3):
        state[FEET + 3 * leg + i] = state[POSITION + i] + r[i, 0] * tip[0] + r[i, 1] * tip[1] + r[i, 2] * tip[2]
        c0, c1, c2 = lever(r, tip, i)
        for j in range(N_ERRORS):
            rows[i, j] = covariance[P + i, j] + c0 * covariance[A, j]
            rows[i, j] += c1 * covariance[A + 1, j] + c2 * covariance[A + 2, j]
    for i in range(3):
        for j in range(N_ERRORS):
            if j < first or j >= first + 3:
                covariance[first + i, j] = rows[i, j]
                covariance[j, first + i] = rows[i, j]
    for i in range(3):
        c0, c1, c2 = lever(r, tip, i)
        for j in range(i, 3):
            total = rows[j, P + i] + c0 * rows[j, A] + c1 * rows[j, A + 1] + c2 * rows[j, A + 2]
            covariance[first + i, first + j] = covariance[first + j, first + i] = total
        covariance[first + i, first + i] += FOOTHOLD_VARIANCE


@compiled()
def update(covariance: Any, h: Any, leg: int, residual: float, change: Any, ph: Any) -> None:
    """Take one number that was measured into account. Its derivative is that of `foothold_derivative`.

    `change` (27,) is the error that is known so far. `ph` (27,) is overwritten.
    """
    foot = F + 3 * leg
    for j in range(N_ERRORS):
        ph[j] = 0.0
    for k in range(3):
        along_p, along_a, along_f = h[k], h[3 + k], h[6 + k]
        for j in range(N_ERRORS):
            ph[j] += along_p * covariance[P + k, j] + along_a * covariance[A + k, j] + along_f * covariance[foot + k, j]
    variance = KINEMATICS_VARIANCE
    expected = 0.0
    for k in range(3):
        variance += h[k] * ph[P + k] + h[3 + k] * ph[A + k] + h[6 + k] * ph[foot + k]
        expected += h[k] * change[P + k] + h[3 + k] * change[A + k] + h[6 + k] * change[foot + k]
    surprise = (residual - expected) / variance
    for i in range(N_ERRORS):
        change[i] += ph[i] * surprise
        share = ph[i] / variance
        for j in range(N_ERRORS):
            covariance[i, j] -= share * ph[j]


@compiled()
def correct(state: Any, change: Any) -> None:
    """Add a known error to the state."""
    for i in range(3):
        state[POSITION + i] += change[P + i]
        state[VELOCITY + i] += change[V + i]
        state[GYRO_BIAS + i] += change[G + i]
        state[ACCELERATION_BIAS + i] += change[B + i]
    for i in range(12):
        state[FEET + i] += change[F + i]
    turn_by(state[QUATERNION : QUATERNION + 4], change[A], change[A + 1], change[A + 2])
