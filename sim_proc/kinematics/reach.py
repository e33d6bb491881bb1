"""Whether a leg reaches the points of a curve."""

import numpy as np

from legpush.arrays import Floats
from legpush.errors import MotionError
from legpush.scene.conventions import JOINTS
from sim_proc.kinematics.leg import LegKinematics

SAME_M = 1e-6
"""A leg reaches a point if its tip comes this near to it."""


def require_reach(kinematics: LegKinematics, what: str, tips_h: Floats, side: float, margin_deg: float) -> None:
    """Check that a leg reaches points (n, 3) in its hip frame, with `margin_deg` left to the limits of its joints.

    `side` is +1 for a left leg and -1 for a right one. `what` names the points in the error.

    Raises:
        MotionError: A point is out of reach, or brings a joint too near to a limit.
    """
    joints = kinematics.inverse(tips_h, side, saturate=True)
    off_m = np.linalg.norm(kinematics.forward(joints, side) - tips_h, axis=-1)
    if not (off_m <= SAME_M).all():
        raise MotionError(f"Expected {what} within reach of the leg, got a point {off_m.max():.2f} m beyond")
    left = np.minimum(joints - kinematics.lower_limits_rad, kinematics.upper_limits_rad - joints).min(axis=0)
    joint = int(left.argmin())
    left_deg = float(np.degrees(left[joint]))
    if left_deg < margin_deg:
        raise MotionError(
            f"Expected {what} at least {margin_deg:g}° away from the limits of the joints, "
            f"got {left_deg:.1f}° at {JOINTS[joint]}"
        )
