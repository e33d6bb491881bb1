"""How many push cycles a mission may use: as many as the scenario says, or as the paths of the box call for."""

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Final

from agent_proc.endings import MissionEndedError
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.least_pushes import least_distance_m, most_travel_m
from agent_proc.pushing.stage import Stage
from legpush.bounds import MAX_PUSH_CYCLES
from legpush.geometry import Pose2
from legpush.scene.names import Face
from legpush.scene.scenario import Scenario

SPARE: Final = 3
"""A path may take this many times the push cycles that its length calls for."""
SPARE_CYCLES: Final = 60
"""Further push cycles for each path, for the short pushes at the ends of stages."""


class PushBudget:
    """The push cycles of a mission; each path that is planned sets automatic ones."""

    def __init__(self, scenario: Scenario, estimates: Mapping[Face, PushEstimate]) -> None:
        """Without a number in the scenario, it follows from the paths."""
        self._scenario = scenario
        self._most = most = scenario.mission.max_push_cycles
        self._estimates = estimates
        self.n_cycles = MAX_PUSH_CYCLES if most is None else most
        """The number that may be used."""

    def require_enough(self, box: Pose2, stages: Sequence[Stage], *, is_reference: bool) -> None:
        """Do nothing if the scenario's number might do for a box that no push has moved yet.

        Raises:
            MissionEndedError: It cannot, even if each push moves the box as far as a push can.
        """
        length_m, travel_m = sum(stage.length_m for stage in stages), most_travel_m(self._scenario)
        to_go_m = least_distance_m(self._scenario, box, length_m if is_reference else None)
        n_least = ceil(to_go_m / travel_m)
        if self._most is not None and self._most < n_least:
            raise MissionEndedError(
                "max_push_cycles",
                f"`mission.max_push_cycles` is {self._most}, but the box has to move {to_go_m:.2f} m or more, and a "
                f"push moves it {travel_m:.2f} m at most: that takes {n_least} push cycles or more",
                self._remedy(SPARE * self._needed(stages, 0.0) + SPARE_CYCLES),
            )

    def take_path(self, stages: Sequence[Stage], n_used: int) -> None:
        """Count the push cycles for a path that begins after `n_used` of them."""
        self.take(self._needed(stages, 0.0), n_used)

    def take(self, n_needed: int, n_used: int) -> None:
        """Count the cycles for a number of pushes that begin after `n_used` of them."""
        if self._most is None:
            self.n_cycles = min(n_used + SPARE * n_needed + SPARE_CYCLES, MAX_PUSH_CYCLES)

    def used_up_on_path(self, stages: Sequence[Stage], at_m: float, what: str) -> MissionEndedError:
        """The error that says how many push cycles would do, at a place on the first of the stages that are left."""
        left_m = sum(stage.length_m for stage in stages) - at_m
        return self.used_up(self._needed(stages, at_m), what, f"{left_m:.2f} m of its path are left")

    def used_up(self, n_needed: int, what: str, left: str) -> MissionEndedError:
        """The error that says how many push cycles would do where `n_needed` usual pushes are left."""
        return MissionEndedError(
            "max_push_cycles",
            f"{what} after {self.n_cycles} push cycles, {left}",
            self._remedy(self.n_cycles + SPARE * n_needed + SPARE_CYCLES),
        )

    def _remedy(self, n_wanted: int) -> str:
        automatic = "" if self._most is None else ", or leave it out: it then follows from the path of the box"
        return f"set `mission.max_push_cycles` to {min(n_wanted, MAX_PUSH_CYCLES)}{automatic}"

    def _needed(self, stages: Sequence[Stage], at_m: float) -> int:
        """Number of usual pushes along the stages, from a place on the first of them on."""
        begins_m = [at_m, *(0.0 for _ in stages[1:])]
        return sum(
            ceil(max(stage.length_m - begin_m, 0.0) / self._estimates[stage.face].usual_travel_m)
            for stage, begin_m in zip(stages, begins_m, strict=True)
        )
