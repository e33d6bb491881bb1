"""Terms of a task, as a package of yours may have them; `straight.toml` is a task with them.

The package registers them in its `pyproject.toml`:

    [project.entry-points."legpush.tasks"]
    along = "terms:Along"
    sideways = "terms:Sideways"
    tilted = "terms:Tilted"
"""

from math import degrees, pi
from typing import ClassVar

import numpy as np

from agent_proc.frames.push_view import PushView
from agent_proc.task.term import AbortTerm, ObservationTerm, PushStep, RewardTerm
from legpush.arrays import Floats
from legpush.scene.scenario import Scenario


class Along(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The box along the line through its goal and beside it."""

    AXES: ClassVar[tuple[str, ...]] = ("along", "beside")
    FRAME: ClassVar[str] = "goal"

    def meaning(self) -> str:
        """What the elements are."""
        return "centre of the box along the line through its goal, and beside it"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The place, (2,)."""
        return np.array([view.box_g.x_m, view.box_g.y_m])

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """As far as the room is long, and twice that."""
        far_m = 2 * float(np.hypot(*scenario.room.size_m))
        return np.full(2, -far_m), np.full(2, far_m)


class Sideways(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far the box is beside the line, m."""

    def value(self, step: PushStep) -> float:
        """The distance."""
        return abs(step.after.box_g.y_m)


class Tilted(AbortTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Gives up where the box heads far off the goal's heading."""

    most_deg: float = 45.0
    """Largest angle between both."""

    def aborts(self, first: PushView, now: PushView) -> bool:
        """Whether it is larger."""
        return degrees(abs((now.box_g.yaw_rad + pi) % (2 * pi) - pi)) > self.most_deg
