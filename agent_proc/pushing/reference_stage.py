"""The reference of a scenario as a stage: the centre of the box follows its curve, and the heading the centre."""

import numpy as np

from agent_proc.pushing.stage import Stage
from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.scene.reference import Reference, reference_curve


def reference_path(reference: Reference, begin: Pose2, axle_m: float) -> Stage:
    """The stage from `begin`, the nominal pose of the box, on, pushed at the rear face."""
    curve = reference_curve(reference, begin)
    headings = trailing(curve, axle_m)
    poses = tuple(
        Pose2(x_m=x_m, y_m=y_m, yaw_rad=wrap_angle(yaw_rad))
        for (x_m, y_m, _), yaw_rad in zip(curve.tolist(), headings.tolist(), strict=True)
    )
    end = Pose2(x_m=poses[-1].x_m, y_m=poses[-1].y_m, yaw_rad=wrap_angle(float(curve[-1, 2])))
    return Stage("rear", poses, axle_m, end)


def trailing(curve: Floats, axle_m: float) -> Floats:
    """Headings, (n,), of a box whose centre goes along a curve (x, y, direction), (n, 3), while a point `axle_m` behind
    it does not slip sideways; at first it heads along the curve.

    Between two points the heading's lag behind the direction decays, as that of a trailer does.
    """
    if axle_m <= 0.0:
        return curve[:, 2].copy()
    steps_m = np.hypot(*np.diff(curve[:, :2], axis=0).T)
    headings = np.empty(len(curve))
    headings[0] = curve[0, 2]
    for k, step_m in enumerate(steps_m.tolist()):
        direction = (curve[k, 2] + curve[k + 1, 2]) / 2
        lag = direction - headings[k]
        headings[k + 1] = direction - 2 * np.arctan(np.tan(lag / 2) * np.exp(-step_m / axle_m))
    return headings
