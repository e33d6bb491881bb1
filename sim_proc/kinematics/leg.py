"""Analytic kinematics of the legs (Eqs. 3 to 7) for arrays of any leading shape.

The hip frame is parallel to the trunk frame, with its origin on the hip-x axis. Joint angles are hip-x (abduction,
about x), hip-y (about y, positive swings the leg backward) and knee (flexion: 0 is the straight leg, and the knee
points backward).
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from legpush.arrays import Floats
from legpush.scene.conventions import LEGS
from legpush.scene.robot import RobotSpec

SIDE: Final = np.array([1.0 if leg.endswith("L") else -1.0 for leg in LEGS])
"""+1 for left legs, -1 for right legs, (4,)."""
LEAST_DROP_M: Final = 1e-3
"""A leg that saturates has its foot at least this far below the hip-y axis in the leg plane."""
LARGEST_DIRECTION_RAD: Final = 3.0
"""Largest direction of a tip about the hip-x axis that is kept, from straight down: nearly straight up."""


class LegKinematics:
    """The kinematics of the legs of one robot."""

    def __init__(self, robot: RobotSpec) -> None:
        legs, joints = robot.legs, robot.joints.in_order()
        self._offset_m, self._upper_m, self._lower_m = legs.hip_offset_m, legs.upper_length_m, legs.lower_length_m
        self._stance = robot.stance
        self._tip_height_m = legs.foot_radius_m - robot.stance.height_m
        self.hips_b: Floats = np.array(
            [
                [legs.hip_x_m if leg.startswith("F") else -legs.hip_x_m, side * legs.hip_y_m, 0.0]
                for leg, side in zip(LEGS, SIDE, strict=True)
            ]
        )
        """Origins of the hip frames in the trunk frame, (4, 3)."""
        self.lower_limits_rad: Floats = np.array([joint.limits_rad[0] for joint in joints])
        self.upper_limits_rad: Floats = np.array([joint.limits_rad[1] for joint in joints])
        """Limits of hip-x, hip-y and knee, (3,)."""
        self._farthest_rad = min(float(np.abs(joints[0].limits_rad).max()) + np.pi / 2, LARGEST_DIRECTION_RAD)
        """The farthest direction of a tip about the hip-x axis, from straight down."""
        l2, l3 = self._upper_m, self._lower_m
        self._reach_squared_m2 = tuple(
            l2**2 + l3**2 + 2 * l2 * l3 * np.cos(angle) for angle in reversed(robot.joints.knee.limits_rad)
        )
        """Least and largest squared distance from the hip-y axis to the tip that the limits of the knee allow."""

    def standing_joints_rad(self) -> Floats:
        """Joint angles of the nominal stance, feet at the corners of the foot rectangle, (4, 3)."""
        tips_b = np.zeros((4, 3))
        tips_b[:, :2] = self._stance.foot_rectangle_b()
        tips_b[:, 2] = self._tip_height_m
        return self.inverse(tips_b - self.hips_b, SIDE)

    def forward(self, joints_rad: ArrayLike, side: ArrayLike) -> Floats:
        """Tips in the hip frame, (..., 3), for joint angles (..., 3).

        `side` is +1 for left legs and -1 for right ones, broadcast over `...`.
        """
        l1, l2, l3 = self._offset_m, self._upper_m, self._lower_m
        q1, q2, q3 = np.moveaxis(np.asarray(joints_rad, dtype=np.float64), -1, 0)
        x = -l2 * np.sin(q2) - l3 * np.sin(q2 - q3)
        z2 = -l2 * np.cos(q2) - l3 * np.cos(q2 - q3)
        y2 = np.asarray(side) * l1
        c1, s1 = np.cos(q1), np.sin(q1)
        return np.stack([x, y2 * c1 - z2 * s1, y2 * s1 + z2 * c1], axis=-1)

    def inverse(self, tips_h: ArrayLike, side: ArrayLike, *, saturate: bool = False) -> Floats:
        """Joint angles, (..., 3), that put the tips at `tips_h` in the hip frame.

        A tip that the leg does not reach gives NaN. There are two solutions: the foot below or above the hip-y axis in
        the leg plane. The one inside the joint limits is taken, or the lower one if both are inside.

        With `saturate` the leg stretches or folds toward the tip as far as its joint limits allow, always with the foot
        below the hip-y axis: joint angles never jump while the tip moves on.
        """
        low, high = self.lower_limits_rad, self.upper_limits_rad
        tips = np.asarray(tips_h, dtype=np.float64)
        side = np.broadcast_to(np.asarray(side, dtype=np.float64), tips.shape[:-1])
        if saturate:
            return np.clip(self._saturated(tips, side), low, high)
        below = self._inverse_branch(tips, side, -1.0)
        inside = np.all((below >= low - 1e-9) & (below <= high + 1e-9), axis=-1)
        if inside.all():
            return below
        above = self._inverse_branch(tips, side, 1.0)
        above_inside = np.all((above >= low - 1e-9) & (above <= high + 1e-9), axis=-1)
        return np.where((~inside & above_inside)[..., None], above, below)

    def _inverse_branch(self, tips: Floats, side: Floats, z_sign: float) -> Floats:
        """The solution whose foot has a `z2` of this sign in the leg plane."""
        l1 = self._offset_m
        x, y, z = np.moveaxis(tips, -1, 0)
        with np.errstate(invalid="ignore"):
            z2 = z_sign * np.sqrt(y * y + z * z - l1 * l1)
            q1 = np.arctan2(z, y) - np.arctan2(z2, side * l1)
            beta2, beta3 = self._angles(x * x + z2 * z2)
        q2 = np.arctan2(-x, -z2) + beta2
        return np.stack([_wrap(q1), _wrap(q2), np.pi - beta3], axis=-1)

    def _saturated(self, tips: Floats, side: Floats) -> Floats:
        """The lower solution, continued beyond the leg's reach without a jump, before the limits of the joints.

        The direction of a tip about the hip-x axis, from straight down, is kept up to the farthest one that the hip
        reaches. From there to straight up, and toward the axis, it turns back to straight down.
        """
        l1 = self._offset_m
        x, y, z = tips[..., 0], tips[..., 1], tips[..., 2]
        z2_squared = y * y + z * z - l1 * l1
        z2 = -np.sqrt(np.maximum(z2_squared, LEAST_DROP_M**2))
        direction, farthest = np.arctan2(y, -z), self._farthest_rad
        beyond = np.copysign(farthest * (np.pi - np.abs(direction)) / (np.pi - farthest), direction)
        direction = np.where(np.abs(direction) <= farthest, direction, beyond)
        direction *= np.minimum(np.hypot(y, z) / l1, 1.0)
        beta2, beta3 = self._angles(np.clip(x * x + z2 * z2, *self._reach_squared_m2))
        joints = np.empty(tips.shape)
        joints[..., 0] = direction - np.arctan2(side * l1, -z2)
        joints[..., 1] = np.arctan2(-x, -z2) + beta2
        joints[..., 2] = np.pi - beta3
        return joints

    def _angles(self, reach_squared_m2: Floats) -> tuple[Floats, Floats]:
        """Angles of the triangle of upper leg, lower leg and reach: at the hip-y axis, and at the knee."""
        l2, l3, b2 = self._upper_m, self._lower_m, reach_squared_m2
        at_hip = np.arccos((l2**2 + b2 - l3**2) / (2 * l2 * np.sqrt(b2)))
        return at_hip, np.arccos((l2**2 + l3**2 - b2) / (2 * l2 * l3))

    def jacobian(self, joints_rad: ArrayLike, side: ArrayLike) -> Floats:
        """Derivative of the tip in the hip frame with respect to the joint angles, (..., 3, 3)."""
        l1, l2, l3 = self._offset_m, self._upper_m, self._lower_m
        joints = np.asarray(joints_rad, dtype=np.float64)
        q1, q2, q3 = joints[..., 0], joints[..., 1], joints[..., 2]
        s2, c2 = np.sin(q2), np.cos(q2)
        s23, c23 = np.sin(q2 - q3), np.cos(q2 - q3)
        s1, c1 = np.sin(q1), np.cos(q1)
        y2 = np.asarray(side) * l1
        z2 = -l2 * c2 - l3 * c23
        z2_by_q2, z2_by_q3 = l2 * s2 + l3 * s23, -l3 * s23
        jacobian = np.zeros((*joints.shape, 3))
        jacobian[..., 0, 1], jacobian[..., 0, 2] = z2, l3 * c23
        jacobian[..., 1, 0] = -y2 * s1 - z2 * c1
        jacobian[..., 1, 1], jacobian[..., 1, 2] = -z2_by_q2 * s1, -z2_by_q3 * s1
        jacobian[..., 2, 0] = y2 * c1 - z2 * s1
        jacobian[..., 2, 1], jacobian[..., 2, 2] = z2_by_q2 * c1, z2_by_q3 * c1
        return jacobian


def _wrap(angle: Floats) -> Floats:
    wrapped: Floats = (angle + np.pi) % (2 * np.pi) - np.pi
    return wrapped
