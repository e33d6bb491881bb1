"""How many push cycles a mission may use: as many as the scenario says, or as the paths of the box call for."""

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Final

from agent_proc.endings import MissionEndedError
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.stage import Stage
from legpush.bounds import MAX_PUSH_CYCLES
from legpush.scene.names import Face

SPARE: Final = 3
"""A path may take this many times the push cycles that its length calls for."""
SPARE_CYCLES: Final = 60
"""Further push cycles for each path, for the short pushes at the ends of stages."""


class PushBudget:
    """The push cycles of a mission; each path that is planned sets automatic ones."""

    def __init__(self, most: int | None, estimates: Mapping[Face, PushEstimate]) -> None:
        """`most` is the scenario's number; None if it follows from the paths."""
        self._most = most
        self._estimates = estimates
        self.n_cycles = MAX_PUSH_CYCLES if most is None else most
        """The number that may be used."""

    def take_path(self, stages: Sequence[Stage], n_used: int) -> None:
        """Count the push cycles for a path that begins after `n_used` of them."""
        if self._most is None:
            n_wanted = n_used + SPARE * self._needed(stages, 0.0) + SPARE_CYCLES
            self.n_cycles = min(n_wanted, MAX_PUSH_CYCLES)

    def used_up(self, stages: Sequence[Stage], at_m: float, what: str) -> MissionEndedError:
        """The error that says how many push cycles would do, at a place on the first of the stages that are left."""
        n_wanted = min(self.n_cycles + SPARE * self._needed(stages, at_m) + SPARE_CYCLES, MAX_PUSH_CYCLES)
        left_m = sum(stage.length_m for stage in stages) - at_m
        automatic = "" if self._most is None else ", or leave it out: it then follows from the path of the box"
        return MissionEndedError(
            "max_push_cycles",
            f"{what} after {self.n_cycles} push cycles, {left_m:.2f} m of its path are left",
            f"set `mission.max_push_cycles` to {n_wanted}{automatic}",
        )

    def _needed(self, stages: Sequence[Stage], at_m: float) -> int:
        """Number of usual pushes along the stages, from a place on the first of them on."""
        begins_m = [at_m, *(0.0 for _ in stages[1:])]
        return sum(
            ceil(max(stage.length_m - begin_m, 0.0) / self._estimates[stage.face].usual_travel_m)
            for stage, begin_m in zip(stages, begins_m, strict=True)
        )
