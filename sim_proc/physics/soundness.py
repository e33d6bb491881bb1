"""Whether the numbers of a simulation are sound, and whether its robot stands."""

from collections.abc import Sequence
from math import cos, radians

import numpy as np

from legpush.arrays import Floats, Integers
from legpush.errors import LegpushError
from legpush.scene.robot import RobotSpec
from sim_proc.headless import mujoco


def require_sound(n_warnings: Integers, qpos: Floats, tick: int) -> None:
    """Check the ticks that were just simulated up to `tick`, with MuJoCo's numbers of warnings and `qpos` (n, 26).

    Raises:
        LegpushError: MuJoCo warned, or the state stopped being finite.
    """
    when = f"between ticks {tick - len(qpos)} and {tick}: the episode cannot go on"
    warnings = np.flatnonzero(n_warnings)
    if len(warnings):
        raise LegpushError(f"MuJoCo warned of {mujoco.mjtWarning(warnings[0]).name} {when}")
    if not np.isfinite(qpos).all():
        raise LegpushError(f"qpos stopped being finite {when}")


class Falls:
    """What counts as a fall of a robot."""

    def __init__(self, robot: RobotSpec) -> None:
        self._upright, self._height_m = cos(radians(robot.fall.tilt_deg)), robot.fall_height_m

    def include(self, qpos: Sequence[float]) -> bool:
        """Whether the trunk leans too far or is too low, from the first six numbers of `qpos`."""
        _, _, height_m, _, x, y = qpos
        return 1 - 2 * (x * x + y * y) < self._upright or height_m < self._height_m
