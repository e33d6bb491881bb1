"""Which way is down, as the robot's IMU tells."""

from math import exp
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import CONTROL_PERIOD_S

ADAPTS_S: Final = 0.5
"""Time constant of the filter."""
DOUBT: Final = 0.02
"""A slope that differs from the assumed one by more is believed, [m/m]."""
BELIEF: Final = 0.01
"""Once it is, it is believed until it differs by less."""


class PlumbLine:
    """Follows the direction of gravity: what the accelerometer reads less the change of the trunk's speed."""

    def __init__(self, assumed: Floats) -> None:
        """Take the floor to slope by `assumed` (2,) as long as nothing else is felt."""
        self._assumed, self._felt, self._is_felt = assumed, assumed, False
        self._knows = False

    @property
    def downhill(self) -> Floats:
        """Where a plumb line from one metre above the floor meets it, relative to the point below that, [m/m], (2,)."""
        return self._felt if self._is_felt else self._assumed

    def feel(self, accelerations_m_s2: Floats, orientations: Floats, speed_change_m_s: Floats) -> None:
        """Take in a motion: what the accelerometer read, (n, s, 3), the attitude at the ends of ticks as quaternions,
        (n, 4), and how much the velocity of the trunk changed, (3,)."""
        n_ticks = len(orientations)
        w, x, y, z = orientations.T
        a, b, c = accelerations_m_s2.mean(axis=1).T
        # The rows of the rotation matrix of a quaternion, times the reading.
        read = [
            ((1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c).mean(),
            (2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z - w * x) * c).mean(),
            (2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c).mean(),
        ]
        gravity = speed_change_m_s / (n_ticks * CONTROL_PERIOD_S) - np.array(read)
        kept = exp(-n_ticks * CONTROL_PERIOD_S / ADAPTS_S) if self._knows else 0.0
        self._knows = True
        self._felt = kept * self._felt + (1 - kept) * gravity[:2] / -gravity[2]
        away = float(np.abs(self._felt - self._assumed).max())
        self._is_felt = away > (BELIEF if self._is_felt else DOUBT)
