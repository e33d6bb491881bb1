"""What a study file sets of a training, and the command that makes the same policy."""

import shlex
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from msgspec import Meta, Struct
from msgspec.structs import asdict

from agent_proc.evaluation.starts import FIRST_FINAL_SEED
from agent_proc.learning.loggers.registry import BUILT_IN
from agent_proc.learning.training_plan import command_of
from agent_proc.profiles.profile import AtLeastTwo, Widths
from agent_proc.studies.seed_trainings import study_text
from agent_proc.task.domain import Interval
from legpush.arguments import words
from legpush.fields import Seed
from legpush.options.learning import DEFAULT_WORLD, TrainOptions
from legpush.options.study import RunStudy
from legpush.scenarios.changes import change_texts

STUDIES_ALONE: Final = {
    *("observation", "reward", "ending", "starts"),
    *("hidden", "normalize_observation", "n_steps", "batch_size"),
}
"""Settings that `legpush train` has not."""
FINAL: Final = "final_"
"""Begin of the settings of the further evaluation, which change nothing in the policy."""
STUDY_FILE: Final = Path("training.toml")


class TrainingCell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A training as a study file sets it."""

    seed: Seed = 0
    """Seed of initial weights, exploration and initial conditions."""
    profile: str = "tuned"
    """A training profile, or the path of a profile file."""
    task: str | None = None
    """Replaces the profile's task: a built-in one, or the path of a task file."""
    observation: str | None = None
    """Task whose observation replaces that of the task, with whether it is mirrored."""
    reward: str | None = None
    """Task whose reward replaces that of the task."""
    ending: str | None = None
    """Task whose rules end the episodes, in place of those of the task."""
    starts: str | None = None
    """Task whose domain, with the offsets of its starts, replaces that of the task."""
    entry: Literal["fixed", "variable"] | None = None
    """Replaces the task's depth of the pushes: the same for all, or chosen by the policy."""
    actions: Literal["continuous", "discrete"] | None = None
    """Replaces the task's form of the action."""
    steps: Annotated[int, Meta(ge=1)] | None = None
    """Replaces the profile's number of push cycles."""
    hidden: Widths | None = None
    """Replaces the widths of the profile's networks."""
    normalize_observation: bool | None = None
    """Replaces whether the profile normalizes observations by running mean and variance."""
    n_steps: AtLeastTwo | None = None
    """Replaces the profile's steps between two updates; PPO only."""
    batch_size: AtLeastTwo | None = None
    """Replaces the profile's size of a batch."""
    final_episodes: Annotated[int, Meta(ge=0, le=10_000)] = 0
    """Starts of a further evaluation of the last policy, which neither a training nor its other evaluations see."""
    final_first_seed: Seed = FIRST_FINAL_SEED
    """Seed of the first of these starts."""
    final_ending: str | None = None
    """Task whose rules end the episodes of that evaluation, in place of those that the policy was trained with."""
    final_starts: str | None = None
    """Task from whose domain that evaluation draws its starts, in place of that of the training."""
    final_scenario: str | None = None
    """Scenario of that evaluation, in place of the one that the policy was trained in."""
    final_world: str | None = None
    """Simulator of that evaluation, in place of the one that the policy was trained in."""
    n_simulators: Annotated[int, Meta(ge=1, le=64)] = 1
    """Simulators to learn with, all in the process of the cell; the result depends on their number."""
    mass_kg: Interval | None = None
    """Draw the mass of the box for each episode."""
    friction: Interval | None = None
    """Draw the friction of the box for each episode."""
    distance_m: Interval | None = None
    """Draw the distance from box to goal for each episode."""
    world: str = DEFAULT_WORLD
    """The simulator: a plug-in, such as `mujoco`, `map` or `map_mean`."""
    init: str | None = None
    """Policy to begin with instead of random weights."""
    loggers: tuple[str, ...] = ()
    """Where its numbers are logged, in its folder: `tensorboard`, `csv`, `wandb`."""
    callbacks: tuple[str, ...] = ()
    """Callbacks of other packages, by name."""
    film_every: Annotated[int, Meta(ge=1)] | None = None
    """Keep an episode for a film of every N-th evaluation, in its folder."""
    film_last: bool = False
    """The same of the last evaluation."""
    scenario: str | None = None
    """Replaces the task's scenario, which has the robot ready to push, and the goal."""
    changes: dict[str, Any] = {}
    """Other fields of the scenario, by their path."""


def command_of_cell(cell: TrainingCell) -> str:
    """The command that makes the policy again: a training, or a study where a training has no such settings."""
    usual = TrainingCell(seed=cell.seed)
    given = {
        name: value
        for name, value in asdict(cell).items()
        if not name.startswith(FINAL) and name != "changes" and value != getattr(usual, name)
    }
    if given.keys() & STUDIES_ALONE:
        plugins = (*cell.callbacks, *(name for name in cell.loggers if name not in BUILT_IN))
        return _study_command(study_text({**given, **cell.changes}, [cell.seed]), plugins)
    options = {name: value for name, value in given.items() if name not in ("n_simulators", "loggers")}
    return command_of(
        TrainOptions(
            **options,
            seed=cell.seed,
            simulators=cell.n_simulators,
            loggers=cell.loggers,
            changes=change_texts(cell.changes),
        )
    )


def _study_command(text: str, plugins: tuple[str, ...]) -> str:
    """The command that writes the file of a study and runs it."""
    content = text.replace("\\", "\\\\").replace("%", "%%").replace("\n", "\\n")
    run = ["legpush", "study", "run", *words(RunStudy(file=STUDY_FILE, policy=plugins))]
    return f"printf {shlex.quote(content)} > {STUDY_FILE} && {shlex.join(run)}"
