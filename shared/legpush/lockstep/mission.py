"""A mission as a function: the seam at which another mission is plugged in."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.world import World
from legpush.runs.report import Report
from legpush.scene.scenario import Scenario

Tell = Callable[[str, float | None, str], None]
"""Gets the phase, the share of it that is done if that is known, and a detail for people."""


class Mission(Protocol):
    """Runs a mission in a world, from its reset to its end."""

    def __call__(
        self,
        world: World,
        scenario: Scenario,
        *,
        seed: int,
        policy: object,
        trust_policy_file: bool,
        push_map: Path | None,
        records: Sequence[StepRecord | PlanRecord],
        tell: Tell,
    ) -> Report:
        """Return the report; `records` grows by every step and every plan of `world`.

        `policy` is the name of a policy or an object with a method `decide`; it may be a model file, which runs code,
        only with `trust_policy_file`.
        """
