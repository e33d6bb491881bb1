"""Checks that a simulation can go on."""

import numpy as np

from legpush.arrays import Floats, Integers
from legpush.errors import LegpushError
from sim_proc.headless import mujoco


def require_sound(warnings: Integers, qpos: Floats, tick: int) -> None:
    """Check the ticks up to `tick` that were just simulated, from MuJoCo's numbers of warnings and `qpos` (n, nq).

    Raises:
        LegpushError: MuJoCo warned, or the state stopped being finite.
    """
    when = f"between ticks {tick - len(qpos)} and {tick}: the episode cannot go on"
    warned = np.flatnonzero(warnings)
    if len(warned):
        raise LegpushError(f"MuJoCo warned of {mujoco.mjtWarning(warned[0]).name} {when}")
    if not np.isfinite(qpos).all():
        raise LegpushError(f"qpos stopped being finite {when}")
