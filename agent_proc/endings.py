"""Why and how a mission ends."""

from dataclasses import dataclass
from typing import Final

from legpush.errors import BadAnswerError, BrokenEpisodeError, LegpushError, MotionError, PolicyError
from legpush.runs.reasons import REASONS, Reason

REASON_OF: Final[dict[type[LegpushError], Reason]] = {
    BadAnswerError: "bad_answer",
    MotionError: "motion_refused",
    BrokenEpisodeError: "episode_broken",
    PolicyError: "policy_failed",
}
"""Errors in the middle of a mission that the same mission would meet again, so that it is over."""


class MissionEndedError(Exception):
    """Ends a mission, for a reason."""

    def __init__(self, reason: Reason, detail: str, remedy: str | None = None) -> None:
        """Without a `remedy`, it is the usual one of the reason."""
        super().__init__(detail)
        self.reason: Reason = reason
        self.remedy: str = REASONS[reason].remedy if remedy is None else remedy


@dataclass(frozen=True, kw_only=True)
class MissionResult:
    """How a mission ended."""

    success: bool
    """The box is within the tolerances of its goal and the robot stands."""
    reason: Reason
    """`success`, or what ended the mission without it."""
    detail: str
    """One sentence for people."""
    remedy: str
    """What would change the reason; empty for a success."""
    handover_distance_m: float | None
    """From trunk to box at the hand-over; None if the mission ended before."""
    n_push_cycles: int
    n_better_paths: int
    """How often a better path was taken while walking."""
    n_replans: int
    """How often a path was given up because an obstacle appeared in it."""
    error: LegpushError | None = None
    """The error that ended the mission, one of `REASON_OF`; to be raised once the report is written."""
