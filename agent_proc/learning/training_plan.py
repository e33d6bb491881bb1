"""What a training is asked to do, how far it is, and what came out."""

from dataclasses import dataclass

from agent_proc.policies.folder import Check
from agent_proc.profiles.profile import AnyProfile
from agent_proc.task.config import TaskConfig


@dataclass(frozen=True, kw_only=True)
class TrainingPlan:
    """What is trained and how; saved with the training."""

    profile: AnyProfile
    task: TaskConfig
    seed: int
    n_simulators: int
    command: str
    versions: dict[str, str]


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a training is."""

    step: int
    steps: int
    mean_return: float | None
    """Of the last episodes; None before the first one has ended."""
    success_rate: float | None
    best: Check | None
    doing: str


@dataclass(frozen=True, kw_only=True)
class TrainingResult:
    """How a training ended."""

    finished: bool
    """Not, where it was asked to stop before."""
    step: int
    best: Check | None
