"""The player: decides which row of a timeline is shown as time passes and people play, pause or seek."""

from math import inf
from typing import Final

from legpush.history.timeline import Timeline
from legpush.scene.conventions import CONTROL_PERIOD_S

SPEEDS: Final = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 25.0)
"""Speeds to choose from, relative to real time."""
CATCH_UP_S: Final = 0.4
"""A player that follows a live run catches up in about this time."""


class Player:
    """A cursor on one timeline, which may grow.

    While it follows the timeline, it moves as fast as the timeline grows and does not stop before the end. Any command
    of people except a change of speed ends that.
    """

    def __init__(self, *, follows: bool) -> None:
        """Start at the beginning, following the timeline or playing in real time."""
        self.follows = follows
        self.is_playing = True
        self.speed = 1.0
        """Simulated seconds per second."""
        self._row = 0.0

    def row(self, timeline: Timeline) -> int:
        """The row to show, in [0, n_rows)."""
        return min(int(self._row), timeline.n_rows - 1)

    def is_at_end(self, timeline: Timeline) -> bool:
        """Whether the last row is shown."""
        return self.row(timeline) >= timeline.n_rows - 1

    def advance(self, seconds: float, timeline: Timeline, *, grows: bool = False) -> None:
        """Let time pass. At the end of the timeline the player waits if the timeline `grows`, and stops otherwise."""
        if not self.is_playing:
            return
        last = timeline.n_rows - 1
        now_s = self._time_s(timeline)
        if self.follows:
            behind_s = float(timeline.time_s[-1]) - now_s
            now_s += max(seconds, behind_s * min(1.0, seconds / CATCH_UP_S))
        else:
            now_s += seconds * self.speed
        self._go_to(now_s, timeline)
        if self._row >= last and not self.follows and not grows:
            self.is_playing = False

    def follow(self) -> None:
        """Go to the end and stay there while it moves."""
        self.follows = self.is_playing = True

    def play(self, timeline: Timeline) -> None:
        """Play from here, or from the beginning if the last row is shown."""
        if self.is_at_end(timeline):
            self._row = 0.0
        self.follows, self.is_playing = False, True

    def pause(self) -> None:
        """Stop here."""
        self.follows = self.is_playing = False

    def seek(self, time_s: float, timeline: Timeline) -> None:
        """Go to a simulated time, and keep playing or pausing."""
        self.follows = False
        self._go_to(time_s, timeline)

    def move_rows(self, n: int, timeline: Timeline) -> None:
        """Move by `n` rows and stop there."""
        self.pause()
        self._row = float(min(max(0, self.row(timeline) + n), timeline.n_rows - 1))

    def move_steps(self, n: int, timeline: Timeline) -> None:
        """Move to the end of the `n`-th step ahead (or behind, if negative) that has rows, and stop there."""
        self.pause()
        ends = [step.first_row + step.n_rows - 1 for step in timeline.steps if step.n_rows]
        row = self.row(timeline)
        ahead, behind = [end for end in ends if end > row], [end for end in reversed(ends) if end < row]
        wanted = (ahead if n > 0 else behind)[: abs(n)]
        if wanted:
            self._row = float(wanted[-1])

    def restart(self) -> None:
        """Go to the beginning, for another timeline."""
        self._row = 0.0

    def _time_s(self, timeline: Timeline) -> float:
        """Simulated time at the cursor, which may lie between rows."""
        row = self.row(timeline)
        share = min(self._row, timeline.n_rows - 1.0) - row
        time_s = timeline.time_s[row : row + 2]
        return float(time_s[0] + share * (time_s[-1] - time_s[0]))

    def _go_to(self, time_s: float, timeline: Timeline) -> None:
        """Move the cursor to a simulated time, within the timeline."""
        times = timeline.tick
        tick = min(max(time_s / CONTROL_PERIOD_S, 0.0), float(times[-1]) if time_s < inf else inf)
        row = max(0, int(times.searchsorted(tick, side="right")) - 1)
        step = float(times[row + 1] - times[row]) if row + 1 < len(times) else 1.0
        self._row = min(row + max(0.0, tick - float(times[row])) / step, float(len(times) - 1))
