"""The kinds of terms that a task consists of. A term of your own is a class derived from one of them.

A term is a record: its fields are its settings in the task file, with the types and bounds that they have here. Equal
views have to give equal values, so that trainings and missions repeat.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Final, Literal

import numpy as np
from msgspec import Meta, Struct

from agent_proc.frames.push_view import PushView
from agent_proc.task.action_config import ActionConfig
from legpush.arrays import Floats
from legpush.bounds import MAX_READING
from legpush.scene.scenario import Scenario

BEYOND_M: Final = 1.0
"""How far the bounds reach beyond the room, and above the box."""

Weight = Annotated[float, Meta(ge=-MAX_READING, le=MAX_READING)]
EpisodeEnding = Literal["success", "fell", "missed", "astray", "refused", "failed", "max_steps"]
"""`success`: the task has nothing left to do, and the box is within the tolerances of its goal. `missed`: the same, but
the box is outside of them. `astray`: the box has slid away from the robot, or a term gave the episode up. `refused`:
the legs cannot follow the push, as on a steep slope. `failed`: a mission ended for another reason."""


class ObservationTerm(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Consecutive elements of an observation."""

    AXES: ClassVar[tuple[str, ...]] = ("x", "y", "z")
    """A name for each element."""
    UNIT: ClassVar[str] = "m"
    FRAME: ClassVar[str] = "world"
    """Frame of a place or direction; empty for other quantities."""
    HAS_MIRROR_IMAGE: ClassVar[bool] = False
    """Whether `read` heeds the mirror sign."""

    FEELS_BOX: ClassVar[bool] = False
    """Whether `read` needs what the pushes of an episode have shown of the box."""

    scale: Weight = 1.0
    """Every element is multiplied by this."""

    def meaning(self) -> str:
        """What the elements are, in a few words."""
        raise NotImplementedError

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The values before they are scaled, one for each axis; `mirror_sign` is -1 in a mirror image, else 1."""
        raise NotImplementedError

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """Lowest and highest values before they are scaled, one for each axis: the room and a metre around it."""
        low, high = room_limits(scenario)
        return low[: len(self.AXES)], high[: len(self.AXES)]


@dataclass(frozen=True, kw_only=True)
class PushStep:
    """A step of an episode: one push cycle."""

    first: PushView
    """After the reset of the episode."""
    before: PushView
    """Before the push."""
    after: PushView
    """After the push."""
    ending: EpisodeEnding | None
    """How the episode ends with this step; None if it goes on."""

    @property
    def arrived(self) -> bool:
        """Whether the episode ends because the task has nothing left to do, successful or not."""
        return self.ending in ("success", "missed")


class RewardTerm(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A part of the reward."""

    weight: Weight = 1.0
    """The value of the term is multiplied by this."""

    def value(self, step: PushStep) -> float:
        """The value of a step before it is weighted."""
        raise NotImplementedError


class ArrivalTerm(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A rule by which a policy has nothing left to do: it ends episodes of a training, and stops the policy."""

    def arrived(self, view: PushView, action: ActionConfig) -> bool:
        """Whether there is nothing left to do."""
        raise NotImplementedError


class AbortTerm(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A rule by which an episode of a training is given up."""

    def aborts(self, first: PushView, now: PushView) -> bool:
        """Whether to give up the episode that began at `first`."""
        raise NotImplementedError


def room_limits(scenario: Scenario) -> tuple[Floats, Floats]:
    """Lowest and highest x, y and z: the room up to the height of the box, and `BEYOND_M` on every side."""
    high = np.array([*scenario.room.size_m, scenario.box.size_m[2]]) + BEYOND_M
    return np.full(3, -BEYOND_M), high
