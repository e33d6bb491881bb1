"""Ends a run at the touchdown of a foot."""

from collections.abc import Iterator

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.conventions import JOINTS
from sim_proc.control.plant import Touchdown


class Landing:
    """Watches the force sensor of a foot while a run goes on, and stops its leg if it moves fast at touchdown."""

    def __init__(self, touchdown: Touchdown, force: int, holds: Floats) -> None:
        """Watch for a touchdown.

        `force` is the column of the sensors with the vertical force of the foot on its surroundings, and `holds`
        (n, steps, 12) are the controls that hold the joints in the places of all steps.
        """
        self._touchdown, self._column, self._holds = touchdown, force, holds
        self._joints = slice(touchdown.leg * len(JOINTS), (touchdown.leg + 1) * len(JOINTS))

    def controls(self, tick: int, controls: Floats, sensors: Floats) -> Iterator[Floats]:
        """Controls (12,) of the steps of a tick, from planned ones (steps, 12), which are replaced if a leg stops.

        `sensors` (steps, n) gets a row after each step.
        """
        touchdown = self._touchdown
        watched = touchdown.stops_leg and touchdown.first_tick <= tick < touchdown.landing_tick
        for step, control in enumerate(controls):
            if watched and step and self._is_down(sensors[step - 1]):
                controls[step:, self._joints] = self._holds[tick, step, self._joints]
                watched = False
            yield control

    def ends(self, tick: int, sensors: Floats) -> bool:
        """Whether the run ends with a tick with sensors (steps, n)."""
        return tick < self._touchdown.landing_tick and self.touched_down(tick, sensors)

    def touched_down(self, tick: int, sensors: Floats) -> bool:
        """Whether the foot touched down in a tick with sensors (steps, n)."""
        return tick >= self._touchdown.first_tick and bool(np.any(self._is_down(sensors)))

    def _is_down(self, sensors: Floats) -> Flags:
        down: Flags = -sensors[..., self._column] >= self._touchdown.force_n
        return down
