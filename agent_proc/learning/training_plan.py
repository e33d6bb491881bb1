"""The plan, the progress and the result of a training."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Final

from agent_proc.policies.card import Check
from agent_proc.profiles.profile import AnyProfile, PpoSettings
from agent_proc.task.config import TaskConfig
from legpush.arguments import words
from legpush.options.learning import DEFAULT_WORLD, TrainOptions

ELSEWHERE: Final = (
    *("out", "resume", "seeds", "workers", "dry_run", "output"),
    *("join", "listen", "connect", "router", "secure", "record"),
)
"""Options of a training that say where it is made and what is told of it, and nothing about its policy."""


OWN_LOGGERS: Final = ("tensorboard", "csv", "wandb")
"""Names of the loggers of this package."""


@dataclass(frozen=True, kw_only=True)
class TrainingPlan:
    """Task, profile and settings of a training; saved in its folder."""

    profile: AnyProfile
    task: TaskConfig
    seed: int
    n_simulators: int
    command: str
    """Makes its policy again."""
    versions: dict[str, str]
    world: str = DEFAULT_WORLD
    """What is pushed in: the simulators, a plug-in, or the file of a response map."""
    init: str | None = None
    """The policy or the folder of the training that it began with; None for random weights."""
    loggers: tuple[str, ...] = ("tensorboard",)
    """Where its numbers are logged, by name."""
    callbacks: tuple[str, ...] = ()
    """Callbacks of other packages, by name."""
    film_every: int | None = None
    """Keep an episode for a film of every N-th evaluation."""
    film_last: bool = False
    """Keep an episode for a film of the last evaluation."""

    @property
    def steps_learned(self) -> int:
        """Push cycles that it learns from: with PPO, those of whole rollouts."""
        steps, settings = self.profile.steps, self.profile.settings
        rollout = settings.n_steps * self.n_simulators if isinstance(settings, PpoSettings) else self.n_simulators
        return -(-steps // rollout) * rollout


def again(folder: Path, loggers: Sequence[str], callbacks: Sequence[str]) -> str:
    """The command that goes on with the training in a folder; it repeats what runs code of other packages."""
    options = TrainOptions(resume=folder, callbacks=tuple(callbacks))
    if others := tuple(name for name in loggers if name not in OWN_LOGGERS):
        options = replace(options, loggers=others)
    return shlex.join(["legpush", "train", *words(options)])


def command_of(options: TrainOptions) -> str:
    """The command that makes the same policy on any host: it has the number of simulators, and no folder."""
    elsewhere: dict[str, Any] = {field.name: field.default for field in fields(options) if field.name in ELSEWHERE}
    given = replace(options, simulators=options.n_simulators, **elsewhere)
    return shlex.join(["legpush", "train", *words(given)])


@dataclass(frozen=True, kw_only=True)
class Progress:
    """Progress of a training."""

    step: int
    steps: int
    mean_return: float | None
    """Mean over the last episodes, like the success rate; None before the first one has ended."""
    success_rate: float | None
    best: Check | None
    doing: str


@dataclass(frozen=True, kw_only=True)
class TrainingResult:
    """How a training ended."""

    finished: bool
    """False if it was asked to stop before its end."""
    step: int
    best: Check | None
    ended_by: str | None = None
    """The callback that ended it before its last step."""
