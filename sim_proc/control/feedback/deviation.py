"""How far the robot usually is from its plans, and how far it may be before it takes capture steps."""

from math import exp, sqrt
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.robot_motion import Capture
from sim_proc.control.balance import ComPlan
from sim_proc.control.watch import Watch
from sim_proc.gravity import GRAVITY_M_S2

LATE_TICKS: Final = 8
"""Largest delay that is looked for."""
CLEAR_SHARE: Final = 0.8
"""Another delay is believed if it leaves at most this share of the mean squared deviation."""


class Deviation:
    """Learns from one motion after another. A payload or an unknown slope deviates all the time, a gust only once."""

    def __init__(self, capture: Capture, height_m: float) -> None:
        """Expect no deviation of a centre of mass at `height_m` above the floor."""
        self._capture = capture
        self._per_speed_s = sqrt(height_m / GRAVITY_M_S2)
        self._usual_m: Floats = np.zeros(2)
        self._more_m = 0.0
        """What is allowed beyond the usual because of trots."""
        self._before_m: Floats = np.zeros((0, 2))
        """The divergent component that was planned for the last ticks, (n, 2)."""
        self._planned_m = self._before_m
        """The same from these ticks on to the end of the present plan."""
        self._errors_m2: Floats = np.zeros(LATE_TICKS + 1)
        """Mean squared deviation from plans that are carried out late by each number of ticks."""
        self.late_ticks = 0
        """By how many ticks the motion is later than planned, as far as is known: commands take time."""
        self._told_ticks: int | None = None
        """By how many ticks it is late as the joints tell; None if nobody looks."""

    def tell(self, late_ticks: int | None) -> None:
        """Take over by how much motions are late, if the joints tell."""
        self._told_ticks = late_ticks
        if late_ticks is not None:
            self.late_ticks = late_ticks

    def watch(self, plan: ComPlan, n_ticks: int, least_heights_m: Floats | None = None) -> Watch:
        """A watch over the first ticks of a planned motion, and over feet that are to stay up, (4,)."""
        planned_m = plan.position_m[:n_ticks] + self._per_speed_s * plan.velocity_m_s[:n_ticks]
        lacking = LATE_TICKS - len(self._before_m)
        self._planned_m = np.concatenate([np.repeat(planned_m[:1], lacking, axis=0), self._before_m, planned_m])
        capture = self._capture
        allowed_m = min(capture.from_m + capture.late_m * self.late_ticks + self._more_m, capture.most_m)
        return Watch(self._late(self.late_ticks, n_ticks), self._per_speed_s, self._usual_m, allowed_m, least_heights_m)

    def _late(self, n_late: int, n_ticks: int) -> Floats:
        """The divergent component after each of the first ticks of a plan that is carried out late, (n, 2)."""
        return self._planned_m[LATE_TICKS - n_late :][:n_ticks]

    def learn(self, watch: Watch, *, rough: bool) -> None:
        """Take the deviation of a motion that was carried out for the usual one, little by little.

        Feet that find their places on a rough floor deviate as late ones do: nothing is learned of a delay there, nor
        where the joints tell of one. A gust may look like a delay, and only the joints tell them apart.
        """
        n_ticks = len(watch.deviations_m)
        if n_ticks == 0:
            return
        self._before_m = self._planned_m[n_ticks : n_ticks + LATE_TICKS]
        kept = exp(-n_ticks / self._capture.adapt_ticks)
        self._more_m *= exp(-n_ticks / self._capture.forget_ticks)
        learns = not rough and self._told_ticks is None
        if learns and (self.late_ticks > 0 or float(np.abs(watch.deviations_m).max()) > self._capture.small_m):
            errors = [watch.reached_m - self._late(late, n_ticks) for late in range(LATE_TICKS + 1)]
            self._errors_m2 = kept * self._errors_m2 + np.array([float((error**2).mean()) for error in errors])
            best = int(np.argmin(self._errors_m2))
            if self._errors_m2[best] < CLEAR_SHARE * self._errors_m2[self.late_ticks]:
                self.late_ticks = best
        self._usual_m = kept * self._usual_m + (1 - kept) * watch.deviations_m.mean(axis=0)

    def allow_more(self) -> None:
        """Allow more for a while, because capture steps have just been taken: they must not go on for ever.

        What was learned before is forgotten, since a push from outside may have taught it.
        """
        self._more_m += self._capture.more_m
        self.forget()

    def forget(self) -> None:
        """Expect no deviation, as at first: the robot has moved otherwise than planned."""
        self._usual_m, self._before_m = np.zeros(2), self._before_m[:0]
        self._errors_m2[:], self.late_ticks = 0.0, self._told_ticks or 0
