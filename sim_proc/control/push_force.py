"""The force of a push: when it acts, and how the feet bear it."""

from dataclasses import dataclass, replace

import numpy as np

from legpush.arrays import Floats
from sim_proc.control.balance import foot_forces
from sim_proc.gravity import GRAVITY_M_S2


@dataclass(frozen=True, kw_only=True)
class PushForce:
    """The planned force of a foot on the box at n ticks."""

    leg: int
    force_n: Floats
    """World frame, (n, 3)."""
    height_m: float
    """Height of the contact point."""

    def after(self, n_ticks: int) -> "PushForce":
        """The same force after `n_ticks` without any."""
        return replace(self, force_n=np.concatenate([np.zeros((n_ticks, 3)), self.force_n]))


def pushing_forces(
    feet_m: Floats, load_share: Floats, zmp_m: Floats, acceleration_m_s2: Floats, mass_kg: float, push: PushForce
) -> Floats:
    """Reaction forces on the feet, (n, 4, 3), of a robot that also pushes a box; arguments as in `foot_forces`.

    The box pushes back at the height of the contact point. So the standing feet give the force of the push besides,
    their centre of pressure moves back by `F h / (m g)` (Eq. 9), and they hold the robot against the turn that the push
    gives it about the vertical. What the foot lifts of the box is a load at that foot. The pushing foot gets the
    reaction of the box. The CoM keeps its plan: leaned forward as far, it would lie over the border of the support.
    """
    along, upward = push.force_n[:, :2], push.force_n[:, 2:]
    weight_n = mass_kg * GRAVITY_M_S2
    carried_n = weight_n + upward
    pressure_m = (weight_n * zmp_m - push.height_m * along + upward * feet_m[:, push.leg, :2]) / carried_n
    acceleration = GRAVITY_M_S2 * (mass_kg * acceleration_m_s2 + along) / carried_n
    forces = foot_forces(feet_m, load_share, pressure_m, acceleration, carried_n / GRAVITY_M_S2)
    forces[:, :, :2] += _turning(forces[:, :, 2], feet_m[:, :, :2] - pressure_m[:, None], push.leg, along)
    forces[:, push.leg] -= push.force_n
    return forces


def _turning(loads_n: Floats, arms_m: Floats, leg: int, along_n: Floats) -> Floats:
    """Forces (n, 4, 2) of feet with loads (n, 4) that balance the moment of a push about their centre of pressure.

    `arms_m` (n, 4, 2) point from there to the feet. The forces add up to zero, as those of a turn do.
    """
    x, y = arms_m[:, leg].T
    moments = x * along_n[:, 1] - y * along_n[:, 0]
    inertias = np.einsum("nl,nli,nli->n", loads_n, arms_m, arms_m)
    across = np.stack([-arms_m[:, :, 1], arms_m[:, :, 0]], axis=2)
    forces: Floats = loads_n[:, :, None] * (moments / inertias)[:, None, None] * across
    return forces
