"""Joint commands for tests."""

import numpy as np

from legpush.arrays import Floats
from sim_proc.control.joint_commands import COMMANDS_PER_TICK, JointCommands


def held(positions_rad: Floats) -> JointCommands:
    """Commands that hold each of the positions (n, 12) for a tick, without feed-forward."""
    positions = np.repeat(positions_rad[:, None], COMMANDS_PER_TICK, axis=1)
    nothing = np.zeros_like(positions)
    return JointCommands(positions_rad=positions, velocities_rad_s=nothing, torques_n_m=nothing)
