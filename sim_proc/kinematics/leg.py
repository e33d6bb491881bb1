"""Analytic kinematics of one leg (Eqs. 3-6) for arrays of any leading shape.

The hip frame is parallel to the trunk frame, with its origin on the hip-x axis. Joint angles are hip-x (abduction,
about x), hip-y (about y, positive swings the leg backward) and knee (flexion: 0 is the straight leg, and the knee
points backward).
"""

import numpy as np
from numpy.typing import ArrayLike

from legpush.arrays import Floats
from legpush.scene.robot import HIP_X_M, HIP_Y_M, JOINT_LIMITS_RAD, JOINTS, L1_M, L2_M, L3_M, LEGS

SIDE = np.array([1.0 if leg.endswith("L") else -1.0 for leg in LEGS])
"""+1 for left legs, -1 for right legs, (4,)."""

HIPS_B = np.array(
    [[HIP_X_M if leg.startswith("F") else -HIP_X_M, side * HIP_Y_M, 0.0] for leg, side in zip(LEGS, SIDE, strict=True)]
)
"""Origins of the hip frames in the trunk frame, (4, 3)."""

LOWER_LIMITS = np.array([JOINT_LIMITS_RAD[joint][0] for joint in JOINTS])
UPPER_LIMITS = np.array([JOINT_LIMITS_RAD[joint][1] for joint in JOINTS])
"""Limits of hip-x, hip-y and knee [rad], (3,)."""

REACH_SQUARED_M2 = tuple(L2_M**2 + L3_M**2 + 2 * L2_M * L3_M * np.cos(JOINT_LIMITS_RAD["knee"][i]) for i in (1, 0))
"""Least and largest squared distance from the hip-y axis to the tip that the limits of the knee allow."""


def forward(joints_rad: ArrayLike, side: ArrayLike) -> Floats:
    """Tips in the hip frame, (..., 3), for joint angles (..., 3).

    `side` is +1 for left legs and -1 for right ones, broadcast over `...`.
    """
    q1, q2, q3 = np.moveaxis(np.asarray(joints_rad, dtype=np.float64), -1, 0)
    x = -L2_M * np.sin(q2) - L3_M * np.sin(q2 - q3)
    z2 = -L2_M * np.cos(q2) - L3_M * np.cos(q2 - q3)
    y2 = np.asarray(side) * L1_M
    c1, s1 = np.cos(q1), np.sin(q1)
    return np.stack([x, y2 * c1 - z2 * s1, y2 * s1 + z2 * c1], axis=-1)


def inverse(tips_h: ArrayLike, side: ArrayLike, *, saturate: bool = False) -> Floats:
    """Joint angles, (..., 3), that put the tips at `tips_h` in the hip frame.

    A tip that the leg does not reach gives NaN. With `saturate` the leg stretches or folds toward it as far as its
    joint limits allow.

    There are two solutions: the foot below or above the hip-y axis in the leg plane. The one inside the joint limits
    is taken, or the lower one if both are inside.
    """
    tips = np.asarray(tips_h, dtype=np.float64)
    side = np.broadcast_to(np.asarray(side, dtype=np.float64), tips.shape[:-1])
    below = _inverse_branch(tips, side, -1.0, saturate=saturate)
    inside = np.all((below >= LOWER_LIMITS - 1e-9) & (below <= UPPER_LIMITS + 1e-9), axis=-1)
    if inside.all():
        return below
    above = _inverse_branch(tips, side, 1.0, saturate=saturate)
    above_inside = np.all((above >= LOWER_LIMITS - 1e-9) & (above <= UPPER_LIMITS + 1e-9), axis=-1)
    joints = np.where((~inside & above_inside)[..., None], above, below)
    return np.clip(joints, LOWER_LIMITS, UPPER_LIMITS) if saturate else joints


def _inverse_branch(tips: Floats, side: Floats, z_sign: float, *, saturate: bool) -> Floats:
    """The solution whose foot has a `z2` of this sign in the leg plane."""
    x, y, z = np.moveaxis(tips, -1, 0)
    z2_squared = y * y + z * z - L1_M * L1_M
    if saturate:
        z2_squared = np.maximum(z2_squared, 1e-6)
    with np.errstate(invalid="ignore"):
        z2 = z_sign * np.sqrt(z2_squared)
        q1 = np.arctan2(z, y) - np.arctan2(z2, side * L1_M)
        b2 = x * x + z2 * z2
        if saturate:
            b2 = np.clip(b2, *REACH_SQUARED_M2)
        b = np.sqrt(b2)
        beta2 = np.arccos((L2_M**2 + b2 - L3_M**2) / (2 * L2_M * b))
        beta3 = np.arccos((L2_M**2 + L3_M**2 - b2) / (2 * L2_M * L3_M))
    q2 = np.arctan2(-x, -z2) + beta2
    return np.stack([_wrap(q1), _wrap(q2), np.pi - beta3], axis=-1)


def jacobian(joints_rad: ArrayLike, side: ArrayLike) -> Floats:
    """Derivative of the tip in the hip frame with respect to the joint angles, (..., 3, 3)."""
    q1, q2, q3 = np.moveaxis(np.asarray(joints_rad, dtype=np.float64), -1, 0)
    s2, c2 = np.sin(q2), np.cos(q2)
    s23, c23 = np.sin(q2 - q3), np.cos(q2 - q3)
    s1, c1 = np.sin(q1), np.cos(q1)
    y2 = np.asarray(side) * L1_M
    z2 = -L2_M * c2 - L3_M * c23
    x_by_q2, x_by_q3 = z2, L3_M * c23
    z2_by_q2, z2_by_q3 = L2_M * s2 + L3_M * s23, -L3_M * s23
    zero = np.zeros_like(s1)
    rows = [
        np.stack([zero, x_by_q2, x_by_q3], axis=-1),
        np.stack([-y2 * s1 - z2 * c1, -z2_by_q2 * s1, -z2_by_q3 * s1], axis=-1),
        np.stack([y2 * c1 - z2 * s1, z2_by_q2 * c1, z2_by_q3 * c1], axis=-1),
    ]
    return np.stack(rows, axis=-2)


def _wrap(angle: Floats) -> Floats:
    wrapped: Floats = (angle + np.pi) % (2 * np.pi) - np.pi
    return wrapped
