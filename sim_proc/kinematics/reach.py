"""Whether a leg reaches the points of a curve."""

import numpy as np

from legpush.arrays import Floats
from legpush.errors import MotionError
from legpush.scene.conventions import JOINTS
from sim_proc.kinematics.leg import LegKinematics


def require_reach(
    kinematics: LegKinematics, what: str, tips_h: Floats, side: float, *, margin_deg: float, within_m: Floats
) -> None:
    """Check that a leg comes within distances (n,) of points (n, 3) in its hip frame.

    Its joints keep `margin_deg` to their limits. `side` is +1 for a left leg and -1 for a right one. `what` names the
    points in the error.

    Raises:
        MotionError: It does not come so near to a point.
    """
    margin = np.radians(margin_deg)
    wanted = kinematics.inverse(tips_h, side, saturate=True)
    joints = np.clip(wanted, kinematics.lower_limits_rad + margin, kinematics.upper_limits_rad - margin)
    off_m = np.linalg.norm(kinematics.forward(joints, side) - tips_h, axis=-1)
    worst = int((off_m - within_m).argmax())
    if off_m[worst] > within_m[worst]:
        left_rad = np.minimum(joints - kinematics.lower_limits_rad, kinematics.upper_limits_rad - joints)[worst]
        raise MotionError(
            f"Expected {what} that the leg follows to {within_m[worst]:g} m, with {margin_deg:g}° left to the limits "
            f"of its joints, got {off_m[worst]:.2f} m, at the limit of {JOINTS[int(left_rad.argmin())]}"
        )
