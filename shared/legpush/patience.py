"""Measures waiting times, without the time in which this process itself was paused."""

from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic
from typing import Final

SLICE_S: Final = 0.05
"""Period at which a wait checks its stop event, the live peers and its deadline."""
LONGEST_SLICE_S: Final = 0.5
"""Most time that one check may add to the time waited. A longer time is a pause of this process, not a slow peer."""


class Stopwatch:
    """Sums the seconds waited in slices of at most `LONGEST_SLICE_S`; call `tick` once per slice."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self.restart()

    def restart(self) -> None:
        """Begin again at 0 s."""
        self.elapsed_s = 0.0
        self._last = self._clock()

    def tick(self) -> float:
        """Return the seconds waited up to now."""
        now = self._clock()
        self.elapsed_s += min(now - self._last, LONGEST_SLICE_S)
        self._last = now
        return self.elapsed_s


@dataclass(frozen=True, kw_only=True)
class Patience:
    """When to send a request again, and when to give up, while a peer does not answer."""

    deadline_s: float = 60.0
    """Give up after this long without an answer from one incarnation of the peer."""
    resend_s: float = 0.1
    """Send the request again after this long, and then after twice as long each time."""
    resend_at_most_s: float = 0.5
    """Longest time until the request is sent again."""
    max_restarts: int = 5
    """Give up when the peer has restarted this many times without a single answer."""
    leave_s: float = 5.0
    """Ask another peer, if there is one that may be asked, when this one has been gone for this long."""
    rival_s: float = 3.0
    """Two live peers of one name are an error after this long; a dead one may still show as live for a lease."""
