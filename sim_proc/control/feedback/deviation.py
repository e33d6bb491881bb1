"""How far the robot usually is from its plans, and how far it may be before it takes capture steps."""

from math import exp, sqrt

import numpy as np

from legpush.arrays import Floats
from legpush.scene.robot_motion import Capture
from sim_proc.control.balance import ComPlan
from sim_proc.control.watch import Watch
from sim_proc.gravity import GRAVITY_M_S2


class Deviation:
    """Learns from one motion after another. A payload or an unknown slope deviates all the time, a gust only once."""

    def __init__(self, capture: Capture, height_m: float) -> None:
        """Expect no deviation of a centre of mass at `height_m` above the floor."""
        self._capture = capture
        self._per_speed_s = sqrt(height_m / GRAVITY_M_S2)
        self._usual_m: Floats = np.zeros(2)
        self._allowed_m = capture.from_m

    def watch(self, plan: ComPlan, n_ticks: int, least_heights_m: Floats | None = None) -> Watch:
        """A watch over the first ticks of a planned motion, and over feet that are to stay up, (4,)."""
        planned_m = plan.position_m[:n_ticks] + self._per_speed_s * plan.velocity_m_s[:n_ticks]
        return Watch(planned_m, self._per_speed_s, self._usual_m, self._allowed_m, least_heights_m)

    def learn(self, watch: Watch) -> None:
        """Take the deviation of a motion that was carried out for the usual one, little by little."""
        n_ticks = len(watch.deviations_m)
        if n_ticks == 0:
            return
        kept = exp(-n_ticks / self._capture.adapt_ticks)
        self._usual_m = kept * self._usual_m + (1 - kept) * watch.deviations_m.mean(axis=0)
        self._allowed_m = self._capture.from_m + kept * (self._allowed_m - self._capture.from_m)

    def allow_more(self) -> None:
        """Allow more for a while, because capture steps have just been taken: they must not go on for ever."""
        self._allowed_m = min(self._allowed_m + self._capture.more_m, self._capture.most_m)
