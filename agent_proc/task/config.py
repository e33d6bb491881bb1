"""A pushing task as one record of plain data: actions, observation, reward, endings, scenario, and what is drawn."""

from functools import cached_property
from typing import Annotated, Any, Final, Literal

from msgspec import UNSET, Meta, UnsetType
from msgspec.structs import asdict, replace

from agent_proc.task.action_config import ActionConfig
from agent_proc.task.domain import Domain
from agent_proc.task.rooms import DRAWN, RoomFields, room_of
from agent_proc.task.term import AbortTerm, ArrivalTerm, ObservationTerm, RewardTerm
from agent_proc.task.terms import make_terms
from legpush.bounds import MAX_PUSH_CYCLES, MAX_TEXT
from legpush.errors import ConfigError
from legpush.fields import Name, require
from legpush.scene.scenario import Scenario

ENDINGS: Final = (ArrivalTerm, AbortTerm)
"""Kinds of terms that end an episode."""
MAX_TERMS: Final = 100
"""Most terms of one kind; each is read at every push."""
Terms = Annotated[dict[Name, dict[str, Any]], Meta(max_length=MAX_TERMS)]
"""Settings of terms by the name that each has in its task, in the order of the task."""
Steps = Annotated[int, Meta(ge=1, le=MAX_PUSH_CYCLES)]


class TaskConfig(ActionConfig, frozen=True, kw_only=True, forbid_unknown_fields=True, dict=True):
    """A pushing task; saved with every policy that was trained on it."""

    description: Annotated[str, Meta(max_length=MAX_TEXT)] = ""
    """One line."""
    observation: Terms
    """Terms of the observation, whose elements follow one another."""
    scaling: Literal["none", "bounds"] = "none"
    """Whether each element of the observation keeps its unit, or is mapped from its bounds to [-1, 1]. Normalizing by
    running mean and variance is a setting of the training profile."""
    reward: Terms
    """Terms of the reward, which are added."""
    ending: Terms
    """Rules by which an episode ends, besides a fall, a box that the robot cannot reach, and `max_steps`."""
    max_steps: Steps = 200
    """Push cycles after which an episode is truncated."""
    scenario: Scenario
    """It starts with the robot at its station, and has the drawn offsets and the goal with its tolerances."""
    domain: Domain = Domain()
    """What episodes of a training draw in its place."""
    evaluation: Literal["scenario", "domain"] = "scenario"
    """Whether evaluations of a training are made in the scenario itself, or each start draws from the domain, too."""
    random_room: RoomFields | UnsetType = UNSET
    """Parameters of a room that is drawn for each episode, as `legpush scenarios random` draws it. An episode is then a
    whole mission in the room, and `max_steps` counts the pushes that the policy decides about. Of the domain, such a
    task may have `mass_kg` and `friction` alone."""

    def __post_init__(self) -> None:
        """Check the task.

        Raises:
            ConfigError: A term or one of its settings is wrong, or cannot be used together with another one.
            PluginError: A term of another package cannot be imported.
        """
        super().__post_init__()
        if self.max_steps < 1:
            raise ConfigError(f"Expected at least 1 for max_steps, got {self.max_steps}")
        for name in ("observation", "reward"):
            if not getattr(self, name):
                raise ConfigError(f"at `{name}`: expected at least one term, got none")
        flat = [name for name, term in self.observation_terms.items() if self.mirrored and not term.HAS_MIRROR_IMAGE]
        if flat:
            raise ConfigError(f"Expected terms with a mirror image in a mirrored task, got {', '.join(flat)}")
        if self.random_room is not UNSET:
            self._check_missions(self.random_room)
        _ = self.reward_terms, self.arrival_terms, self.abort_terms

    def with_max_steps(self, n: int) -> "TaskConfig":
        """Return the task with another length of its episodes, which Gymnasium calls `max_episode_steps`.

        Raises:
            ConfigError: It is below 1 or above 10 000.
        """
        require(Steps, n, "max_episode_steps")
        return replace(self, max_steps=n)

    def _check_missions(self, given: RoomFields) -> None:
        """Check a task whose episodes are missions.

        Raises:
            ConfigError: It has what the mission decides, or what the room has.
        """
        room_of(given)
        if self.changes_face:
            raise ConfigError("Expected no `changes_face` with `random_room`: the path of the box decides the face")
        if others := [name for name, value in asdict(self.domain).items() if value is not None and name not in DRAWN]:
            raise ConfigError(
                f"Expected {' and '.join(DRAWN)} alone in the domain with `random_room`, which has the rest, got "
                f"{', '.join(others)}"
            )

    @cached_property
    def observation_terms(self) -> dict[str, ObservationTerm]:
        """The terms of the observation by their names."""
        return make_terms(self.observation, (ObservationTerm,), "observation")

    @property
    def feels_box(self) -> bool:
        """Whether the observation has what the pushes of an episode have shown of the box.

        Depths are then measured from what this box loses of them, in trainings as in missions.
        """
        return any(term.FEELS_BOX for term in self.observation_terms.values())

    @cached_property
    def reward_terms(self) -> dict[str, RewardTerm]:
        """The terms of the reward by their names."""
        return make_terms(self.reward, (RewardTerm,), "reward")

    @cached_property
    def arrival_terms(self) -> tuple[ArrivalTerm, ...]:
        """Rules by which there is nothing left to do."""
        return tuple(term for term in self._ending_terms.values() if isinstance(term, ArrivalTerm))

    @cached_property
    def abort_terms(self) -> tuple[AbortTerm, ...]:
        """Rules by which an episode is given up."""
        return tuple(term for term in self._ending_terms.values() if isinstance(term, AbortTerm))

    @cached_property
    def _ending_terms(self) -> dict[str, ArrivalTerm | AbortTerm]:
        return make_terms(self.ending, ENDINGS, "ending")
