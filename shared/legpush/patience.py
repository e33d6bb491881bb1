"""Stopwatch and deadlines that ignore the time in which this process was paused."""

from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic
from typing import Final

SLICE_S: Final = 0.05
"""How often a wait checks its stop event, its peers and its deadline."""
LONGEST_SLICE_S: Final = 0.5
"""Most that one check may add to the time waited: more than that was a pause of this process, not a slow peer."""


class Stopwatch:
    """Seconds waited, as a sum of slices of at most `LONGEST_SLICE_S`; `tick` once per slice."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self.restart()

    def restart(self) -> None:
        """From now on, nothing has been waited yet."""
        self.elapsed_s = 0.0
        self._last = self._clock()

    def tick(self) -> float:
        """Seconds waited up to now."""
        now = self._clock()
        self.elapsed_s += min(now - self._last, LONGEST_SLICE_S)
        self._last = now
        return self.elapsed_s


@dataclass(frozen=True, kw_only=True)
class Patience:
    """When to ask again, and when to give up, while a peer does not answer."""

    deadline_s: float = 60.0
    """Give up after this long without an answer from one incarnation of the peer."""
    resend_s: float = 0.1
    """Ask again after this long; each further time after twice as long."""
    resend_at_most_s: float = 0.5
    """Ask again at least this often."""
    max_restarts: int = 5
    """Give up when the peer was restarted this many times without answering once."""
    rival_s: float = 3.0
    """Two live peers of one name are an error after this long: a dead one can linger for a lease."""
