"""Whether the numbers of a simulation are sound."""

import numpy as np

from legpush.arrays import Floats, Integers
from legpush.errors import LegpushError
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
