"""The plan, the progress and the result of a training."""

from dataclasses import dataclass

from agent_proc.policies.folder import Check
from agent_proc.profiles.profile import AnyProfile
from agent_proc.task.config import TaskConfig
from legpush.options.learning import DEFAULT_WORLD


@dataclass(frozen=True, kw_only=True)
class TrainingPlan:
    """Task, profile and settings of a training; saved in its folder."""

    profile: AnyProfile
    task: TaskConfig
    seed: int
    n_simulators: int
    command: str
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
