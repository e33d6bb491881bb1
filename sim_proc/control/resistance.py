"""What holds a box back, as the pushing foot feels it.

It lives in the control of pushes, since a foot feels the box whatever decides about the pushes: missions, trainings and
recordings need no further message for it, and a replay feels the same again.
"""

from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.scenario import Box
from sim_proc.gravity import GRAVITY_M_S2

GAIN: Final = 0.5
"""Share of the difference between what a push felt and what was expected that counts from the next push on."""
STRUCK_TICKS: Final = 3
"""Ticks after the first contact in which a foot feels more than what holds the box back."""


class Resistance:
    """The force that a foot needs to slide the box, in the pushed frame of FL; FR needs its mirror image."""

    def __init__(self, box: Box) -> None:
        """Expect what the scenario says: the friction of a box that slides straight ahead on a level floor."""
        self.force_n: Floats = np.array([box.friction * box.mass_kg * GRAVITY_M_S2, 0.0, 0.0])
        """Forward, left and up, (3,)."""

    def feel(self, forces_n: Floats) -> None:
        """Learn from the forces of the foot on the box at the ticks of a push, (n, 3), in the pushed frame of FL.

        The median of the ticks after the first contact counts: the box slides during most of them, or stands because
        the force does not suffice, which is then all that the foot can tell.
        """
        touched = np.flatnonzero(forces_n[:, 0] > 0.0)
        if len(touched) == 0 or touched[0] + STRUCK_TICKS >= len(forces_n):
            return
        felt_n = np.median(forces_n[touched[0] + STRUCK_TICKS :], axis=0)
        self.force_n = self.force_n + GAIN * (felt_n - self.force_n)
