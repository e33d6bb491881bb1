"""The time from a command to its servo."""

from collections import deque
from collections.abc import Iterable, Iterator

import numpy as np

from legpush.arrays import Floats
from sim_proc.model.world import PHYSICS_STEP_S


class CommandDelay:
    """Gives each command some physics steps late."""

    def __init__(self, latency_s: float, first: Floats) -> None:
        """Before the first command arrives, the servos have `first` (12,)."""
        self._waiting = deque([first.copy() for _ in range(round(latency_s / PHYSICS_STEP_S))])

    def copy(self) -> "CommandDelay":
        """A delay in which the same commands wait, apart from this one."""
        other = CommandDelay(0.0, np.empty(0))
        other._waiting = deque(self._waiting)
        return other

    def one_by_one(self, controls: Iterable[Floats]) -> Iterable[Floats]:
        """What the servos get while commands (12,) are made, step by step."""
        return self._delayed(controls) if self._waiting else controls

    def _delayed(self, controls: Iterable[Floats]) -> Iterator[Floats]:
        for control in controls:
            self._waiting.append(control.copy())
            yield self._waiting.popleft()

    def of_ticks(self, controls: Floats) -> Floats:
        """What the servos get in ticks with commands (n, steps, 12)."""
        if not self._waiting:
            return controls
        return np.array(list(self._delayed(controls.reshape(-1, controls.shape[-1])))).reshape(controls.shape)

    def as_bytes(self) -> bytes:
        """The commands that wait."""
        return b"".join(control.tobytes() for control in self._waiting)
