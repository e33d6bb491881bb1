"""Whether the robot moves as planned: its divergent component of motion beside the planned one, tick by tick."""

from math import inf

import numpy as np

from legpush.arrays import Floats


class Watch:
    """The divergent component of motion that a plan has at its ticks, and how far the measured one may be from it.

    The divergent component is `c + v / omega`, of the centre of mass c and its velocity v: where the robot would have
    to step to in order to come to rest (the capture point).
    """

    def __init__(
        self,
        planned_m: Floats,
        per_speed_s: float,
        usual_m: Floats,
        allowed_m: float,
        least_heights_m: Floats | None = None,
    ) -> None:
        """Watch a plan with the divergent component `planned_m` (n, 2) at the ends of its ticks.

        `per_speed_s` is 1 / omega. A deviation is counted from the usual one, (2,), and ends a run if it is more than
        `allowed_m`. So does a foot lower than its least height, (4,): it has slipped off something.
        """
        self._planned_m, self._per_speed_s, self._least_heights_m = planned_m, per_speed_s, least_heights_m
        self._usual_m, self._allowed_m = usual_m, allowed_m
        self.pressing_n = inf
        """A foot that presses the box harder than this moves the robot itself: then there is no alarm."""
        self.reached_m: Floats = np.zeros((0, 2))
        """The divergent component of the motion that was looked at last, (n, 2)."""
        self.deviations_m: Floats = np.zeros((0, 2))
        """How far the motion that was looked at last was from the plan, (n, 2), with its last tick that of an alarm."""

    def forget(self) -> None:
        """Take the motion that was looked at last for one that tells nothing of the usual deviation."""
        self.deviations_m = np.zeros((0, 2))

    def alarm(self, com_m: Floats, com_velocity_m_s: Floats, tips_m: Floats) -> int | None:
        """The first tick after which a motion is too far from the plan, if it is.

        The motion is that of the centre of mass, (n, 3) and (n, 3), and of the centres of the feet, (n, 4, 3), at the
        ends of the plan's first n ticks.
        """
        self.reached_m = com_m[:, :2] + self._per_speed_s * com_velocity_m_s[:, :2]
        self.deviations_m = self.reached_m - self._planned_m[: len(com_m)]
        x, y = (self.deviations_m - self._usual_m).T
        beyond = x * x + y * y > self._allowed_m**2
        if self._least_heights_m is not None:
            beyond |= (tips_m[:, :, 2] < self._least_heights_m).any(axis=1)
        if not beyond.any():
            return None
        first = int(np.argmax(beyond))
        self.deviations_m = self.deviations_m[: first + 1]
        return first
