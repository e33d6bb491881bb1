"""Ends a run at the touchdown of a foot."""

from collections.abc import Iterable, Iterator
from functools import cached_property
from math import ceil
from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.conventions import JOINTS
from sim_proc.control.plant import Touchdown

BLOCKED_SHARE: Final = 0.25
"""A joint that stays behind by an angle that costs this share of its largest torque does not move freely."""

LIFTED_SHARE: Final = 0.5
"""A foot that carries less than this share of what it carries when it is down is in the air."""
SUDDEN_SHARE: Final = 0.3
"""Nor does one that has come to stay behind by this share of that angle since the leg became slow."""
MOST_LATE_TICKS: Final = 8
"""Largest delay of a leg that is looked for in its flight."""
STILL_RAD: Final = 2e-3
"""A joint of a leg that has not flown before, which turns farther in a tick, moves on: it may only be late."""

Lag = tuple[slice, Floats, Floats]


class Landing:
    """Watches the force sensor of a foot while a run goes on, and stops its leg if it moves fast at touchdown."""

    def __init__(
        self,
        touchdown: Touchdown,
        forces: slice,
        holds: Floats,
        joints: Lag,
        *,
        least_n: float = 0.0,
        late_steps: int = 0,
    ) -> None:
        """Watch for a touchdown.

        `forces` are the columns of the sensors with the vertical forces of the feet on their surroundings, and `holds`
        (n, steps, 12) are the controls that hold the joints in the places of all steps. `joints` are the columns of the
        measured joint angles, the planned angles (n, steps, 12), and how far the joints may stay behind them, (12,).

        Sensors that are `late_steps` old are compared with what was planned then. A smaller force than `least_n` is no
        touchdown.
        """
        self._force_n = max(touchdown.force_n, least_n)
        self._touchdown, self._forces, self._holds = touchdown, forces, holds
        self._force = forces.start + forces.step * touchdown.leg
        """Column of the vertical force of the foot."""
        self._measured, positions, self._allowed_rad = joints
        self._sensed_late_steps = late_steps
        self._positions = _earlier(positions, late_steps) if late_steps else positions
        self._lifted = late_steps == 0 or touchdown.first_tick == touchdown.lift_tick
        """Whether the foot has been in the air. One that is known late may seem to be down before it is lifted."""
        self._flown: dict[int, Floats] = {}
        """Measured angles of the leg at the ends of the ticks of its flight."""
        self._usual_rad: Floats = np.zeros(len(JOINTS))
        """How far the joints of the leg stay behind when it has become slow."""
        self._joints = slice(touchdown.leg * len(JOINTS), (touchdown.leg + 1) * len(JOINTS))

    def controls(self, tick: int, controls: Floats, sensors: Floats) -> Iterable[Floats]:
        """Controls (12,) of the steps of a tick, from planned ones (steps, 12), which are replaced if a leg stops.

        `sensors` (steps, n) gets a row after each step.
        """
        return self._stopping(tick, controls, sensors) if self.may_stop(tick) else controls

    def may_stop(self, tick: int) -> bool:
        """Whether the leg may stop within a tick."""
        touchdown = self._touchdown
        return touchdown.stops_leg and touchdown.first_tick <= tick < touchdown.landing_tick

    def next_look(self, tick: int, n_ticks: int) -> int:
        """The tick, of those of a run, before which a run that has come to `tick` has to look whether it ends."""
        touchdown = self._touchdown
        if tick < touchdown.lift_tick:
            return min(touchdown.lift_tick, n_ticks)
        if tick < touchdown.first_tick:
            return min(touchdown.first_tick, n_ticks)
        return tick + 1 if tick < touchdown.landing_tick else n_ticks

    def _stopping(self, tick: int, controls: Floats, sensors: Floats) -> Iterator[Floats]:
        force_n, column = self._force_n, self._force
        yield controls[0]
        for step in range(1, len(controls)):
            if self._lifted and -sensors.item(step - 1, column) >= force_n:
                controls[step:, self._joints] = self._holds[tick, step, self._joints]
                yield from controls[step:]
                return
            yield controls[step]

    def ends(self, tick: int, sensors: Floats) -> bool:
        """Whether the run ends with a tick with sensors (steps, n)."""
        touched_down = tick < self._touchdown.landing_tick and self.touched_down(tick, sensors)
        return touched_down or self.not_down(tick, sensors) is not None

    def touched_down(self, tick: int, sensors: Floats) -> bool:
        """Whether the foot touched down in a tick with sensors (steps, n)."""
        if not self._lifted and tick >= self._touchdown.lift_tick:
            self._lifted = bool(-sensors[:, self._force].mean() < LIFTED_SHARE * self._force_n)
        if tick < self._touchdown.first_tick or not self._lifted:
            return False
        if tick < self._touchdown.blocked_tick:
            self._flown[tick] = sensors[-1, self._measured][self._joints]
        is_down = (-sensors[:, self._force] >= self._force_n).any()
        return bool(is_down) or self._is_blocked(tick, sensors)

    def _is_blocked(self, tick: int, sensors: Floats) -> bool:
        """Whether a slow leg is stopped by something that its foot does not feel, such as an edge under the shank."""
        if tick < self._touchdown.blocked_tick:
            return False
        measured = sensors[:, self._measured][:, self._joints]
        allowed_rad = self._allowed_rad[self._joints]
        if not self._flown:
            still = np.abs(measured[-1] - measured[0]) < STILL_RAD
            behind = np.abs(self._positions[tick][:, self._joints] - measured) > allowed_rad
            return bool(behind.any() and still.all())
        steps = np.arange(tick * len(measured), (tick + 1) * len(measured)) - self._late_steps
        behind_rad = (
            self._positions.reshape(-1, self._positions.shape[-1])[np.maximum(steps, 0), self._joints] - measured
        )
        slow_tick = self._touchdown.blocked_tick + ceil((self._late_steps + self._sensed_late_steps) / len(measured))
        if tick <= slow_tick:
            self._usual_rad = behind_rad[-1]
        suddenly = np.abs(behind_rad - self._usual_rad) > SUDDEN_SHARE * allowed_rad
        return bool(((np.abs(behind_rad) > allowed_rad) | suddenly).any(axis=1).all())

    @cached_property
    def _late_steps(self) -> int:
        """By how many steps the leg moved later than planned in its flight: commands take time."""
        rows = self._positions.reshape(-1, self._positions.shape[-1])[:, self._joints]
        ends = (np.array(list(self._flown)) + 1) * self._positions.shape[1] - 1
        late = np.arange(MOST_LATE_TICKS * self._positions.shape[1] + 1)
        errors = rows[np.maximum(ends - late[:, None], 0)] - np.array(list(self._flown.values()))
        return int(np.argmin(np.abs(errors).sum(axis=(1, 2))))

    def not_down(self, tick: int, sensors: Floats) -> int | None:
        """The leg whose foot is not down at the end of a tick after which another foot is to be lifted."""
        if tick + 1 != self._touchdown.lift_tick:
            return None
        down: Flags = -sensors[-1, self._forces] >= self._touchdown.force_n
        down[[self._touchdown.leg, *self._touchdown.carried]] = True
        return None if down.all() else int(np.argmin(down))


def _earlier(planned: Floats, n_steps: int) -> Floats:
    """What was planned some steps before, from what is planned for all steps of a run, (n, steps, 12)."""
    rows = planned.reshape(-1, planned.shape[-1])
    earlier: Floats = rows[np.maximum(np.arange(len(rows)) - n_steps, 0)].reshape(planned.shape)
    return earlier
