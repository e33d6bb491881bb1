"""Why and how a mission ends."""

from dataclasses import dataclass

from legpush.runs.report import Reason


class MissionEndedError(Exception):
    """Ends a mission, for a reason."""

    def __init__(self, reason: Reason, detail: str) -> None:
        super().__init__(detail)
        self.reason: Reason = reason


@dataclass(frozen=True, kw_only=True)
class MissionResult:
    """How a mission ended."""

    success: bool
    """The box is within the tolerances of its goal and the robot stands."""
    reason: Reason
    """`success`, or what ended the mission without: the robot `fell` or is `stuck`, the `box_tipped` over, the planner
    found `no_path`, the approach `missed_station`, the box `left_reference`, `max_push_cycles` were not enough, or
    pushing ended with the `tolerance_missed`."""
    detail: str
    """One sentence for people."""
    handover_distance_m: float | None
    """From trunk to box at the hand-over; None if the mission ended before."""
    n_push_cycles: int
    n_better_paths: int
    """How often a better path was taken while walking."""
    n_replans: int
    """How often a path was given up because an obstacle appeared in it."""
