"""The plan of a training by its options, and the folder of a training."""

from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

import msgspec

from agent_proc.learning.plan_file import require_initial
from agent_proc.learning.training_plan import TrainingPlan, command_of
from agent_proc.profiles.profile import load_profile
from agent_proc.simulators import MAP_SUFFIX
from agent_proc.task.config import TaskConfig
from agent_proc.task.file import load_task
from agent_proc.task.rooms import refuse_missions
from agent_proc.task.worlds import of_training, require_known
from legpush.errors import ConfigError
from legpush.options.checks import require_writable_folder
from legpush.options.learning import TrainOptions
from legpush.options.scenarios import changed_scenario, with_changes
from legpush.scene.scenario import Scenario
from legpush.versions import installed_versions


def plan_of(options: TrainOptions) -> TrainingPlan:
    """Make the plan of a training.

    Raises:
        ConfigError: An option cannot be used.
        PolicyError: There is no policy to begin with.
        PluginError: There is no such world.
    """
    from agent_proc.learning.loggers.registry import require_tools

    profile = load_profile(options.profile)
    require_tools(options.loggers, options.callbacks, (*options.loggers, *options.callbacks))
    if options.steps is not None:
        profile = msgspec.structs.replace(profile, steps=options.steps)
    task = _task(options, profile.task)
    refuse_missions(task.random_room)
    if options.init is not None:
        require_initial(profile, task, options.init)
    require_known(
        options.world,
        lambda scenario: of_training(
            task if scenario is None else _task(replace(options, scenario=scenario), profile.task)
        ),
    )
    return TrainingPlan(
        profile=profile,
        task=task,
        seed=options.seed,
        n_simulators=options.n_simulators,
        command=command_of(options),
        versions={name: version for name, version in installed_versions().items() if version is not None},
        world=str(Path(options.world).absolute()) if options.world.endswith(MAP_SUFFIX) else options.world,
        init=options.init,
        loggers=options.loggers,
        callbacks=options.callbacks,
        film_every=options.film_every,
        film_last=options.film_last,
    )


def folder_of(options: TrainOptions, entry: str) -> Path:
    """Choose the folder of a training that begins, which can be made.

    Raises:
        ConfigError: It cannot be written to, or something is in it.
    """
    folder = options.out or Path("runs") / f"{begin_of_name(options)}-{entry}-seed{options.seed}"
    require_writable_folder(folder, "--out")
    if folder.exists() and any(folder.iterdir()):
        raise ConfigError(f"Expected a new or empty folder for --out, got {folder}; --resume {folder} goes on in it")
    return folder


def begin_of_name(options: TrainOptions) -> str:
    """Begin of the name of a folder that is not given."""
    return f"{datetime.now().astimezone():%Y%m%d-%H%M%S}-train-{Path(options.profile).stem}"


def _task(options: TrainOptions, of_profile: str) -> TaskConfig:
    """The task with what the options replace (`ConfigError`, `ScenarioError`)."""
    return load_task(
        options.task or of_profile,
        _scenario(options, of_profile),
        **_given(entry=options.entry, action_form=options.actions),
        domain=_given(mass_kg=options.mass_kg, friction=options.friction, distance_m=options.distance_m),
    )


def _scenario(options: TrainOptions, task: str) -> Scenario | None:
    """The scenario that replaces that of the task, or None."""
    if options.scenario is not None:
        return changed_scenario(options.scenario, options.changes)
    if not options.changes:
        return None
    return with_changes(load_task(options.task or task).scenario, options.changes)


def _given(**values: Any) -> dict[str, Any]:
    """The values that are not None."""
    return {name: value for name, value in values.items() if value is not None}
