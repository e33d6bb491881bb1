"""The kind of cell `training`: a whole training in one process, with its best policy as a column."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, Final

import msgspec
from msgspec import Struct
from msgspec.structs import replace

from agent_proc.learning.loggers.registry import require_tools
from agent_proc.learning.plan_file import require_initial
from agent_proc.learning.training import BEST, LAST
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.policies.folder import read_policy
from agent_proc.profiles.profile import AnyProfile, load_profile, read_profile
from agent_proc.studies.cell_parts import (
    new_simulator,
    require_policy,
    require_simulator,
    sha256_of_policy,
)
from agent_proc.studies.final_evaluation import FINAL_COLUMNS, final_columns
from agent_proc.studies.training_run import of_last, pack, train_in
from agent_proc.studies.training_settings import TrainingCell, command_of_cell
from agent_proc.task.config import TaskConfig
from agent_proc.task.file import load_task
from agent_proc.task.rooms import refuse_missions
from agent_proc.task.worlds import of_training, require_known
from legpush.fields import Seed, require_seeds
from legpush.lockstep.local import LocalWorld
from legpush.runs.temporary import temporary_folder
from legpush.scenarios.changes import override
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column
from legpush.versions import installed_versions

COLUMNS: Final = (
    Column(name="steps_done", unit="", about="push cycles that were trained"),
    Column(name="best_step", unit="", about="step of the best policy"),
    Column(name="success_rate", unit="", about="of the best policy in its evaluation"),
    Column(name="position_error_m", unit="m", about="mean of the best policy"),
    Column(name="angle_error_deg", unit="deg", about="mean of the best policy"),
    Column(name="falls", unit="", about="falls in the evaluation of the best policy"),
    Column(name="cycles", unit="", about="mean number of pushes of the best policy"),
    Column(name="last_success_rate", unit="", about="of the last policy in its evaluation"),
    Column(name="last_position_error_m", unit="m", about="mean of the last policy"),
    Column(name="last_angle_error_deg", unit="deg", about="mean of the last policy"),
    Column(name="last_falls", unit="", about="falls in the evaluation of the last policy"),
    Column(name="n_evaluated", unit="", about="episodes of an evaluation"),
    Column(name="episode_step", unit="", about="by each episode of the training: push cycles before its end"),
    Column(name="episode_return", unit="", about="by each episode: sum of its rewards"),
    Column(name="episode_success", unit="", about="by each episode: whether the box ended within the tolerances"),
    Column(name="episode_position_error_m", unit="m", about="by each episode, at its end"),
    Column(name="episode_angle_error_deg", unit="deg", about="by each episode, at its end"),
    *FINAL_COLUMNS,
    Column(name="policy_zip", unit="", about="folder of the best policy, as a zip file in base64", may_differ=True),
)


FLAGS: Final = ("world", "scenario")
FINAL_FLAGS: Final = ("final_world", "final_scenario")


class ResolvedTraining(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A training that needs no other file."""

    seed: Seed
    profile: dict[str, Any]
    task: TaskConfig
    final_episodes: int
    final_first_seed: Seed
    final_task: TaskConfig
    """The task of the further evaluation: the same but for its rules, its starts and its scenario."""
    final_world: str
    n_simulators: int
    world: str
    init: str | None
    init_sha256: str
    loggers: tuple[str, ...]
    callbacks: tuple[str, ...]
    film_every: int | None
    film_last: bool
    command: str
    """Makes the policy again."""


def resolve(cell: TrainingCell, allowed: Collection[str]) -> ResolvedTraining:
    """Load profile and scenario.

    Raises:
        ConfigError: The profile, the task or the world cannot be used.
        PolicyError: The policy to begin with cannot be used.
        ScenarioError: The scenario or a change cannot be used.
    """
    final_world = cell.world if cell.final_world is None else cell.final_world
    for world in (cell.world, final_world):
        require_simulator(world)
    require_seeds(cell.final_first_seed, cell.final_episodes, "final_first_seed")
    require_tools(cell.loggers, cell.callbacks, allowed)
    profile = _profile(cell)
    name = cell.task or profile.task

    def in_scenario(scenario: str | None) -> TaskConfig:
        loaded = load_task(name).scenario if scenario is None else load_scenario(scenario)
        return _task(cell, name, override(loaded, cell.changes, "the scenario with the changes of the study"))

    task = in_scenario(cell.scenario)
    refuse_missions(task.random_room)
    if cell.init is not None:
        require_initial(profile, task, cell.init)
    require_known(cell.world, lambda named: of_training(task if named is None else in_scenario(named)), *FLAGS)
    final_task = _final_task(cell, task)

    def final(scenario: str) -> TaskConfig:
        return _final_task(replace(cell, final_scenario=scenario), task)

    if cell.final_episodes:
        require_known(
            final_world, lambda named: of_training(final_task if named is None else final(named)), *FINAL_FLAGS
        )
    return ResolvedTraining(
        seed=cell.seed,
        profile=msgspec.to_builtins(profile),
        task=task,
        final_episodes=cell.final_episodes,
        final_first_seed=cell.final_first_seed,
        final_task=final_task,
        final_world=final_world,
        n_simulators=cell.n_simulators,
        world=cell.world,
        init=cell.init,
        init_sha256="" if cell.init is None else sha256_of_policy(cell.init, allowed),
        loggers=cell.loggers,
        callbacks=cell.callbacks,
        film_every=cell.film_every,
        film_last=cell.film_last,
        command=command_of_cell(cell),
    )


def _task(cell: TrainingCell, name: str, scenario: Scenario) -> TaskConfig:
    """The task with the parts and values of the cell.

    Raises:
        ConfigError: A task cannot be used, or its parts do not fit one another.
    """
    replaced: dict[str, Any] = {"entry": cell.entry, "action_form": cell.actions}
    if cell.observation is not None:
        other = load_task(cell.observation, scenario)
        replaced |= {"observation": other.observation, "mirrored": other.mirrored}
    if cell.reward is not None:
        replaced["reward"] = load_task(cell.reward, scenario).reward
    if cell.ending is not None:
        replaced["ending"] = load_task(cell.ending, scenario).ending
    task = load_task(name, scenario, **{part: value for part, value in replaced.items() if value is not None})
    domain = task.domain if cell.starts is None else load_task(cell.starts, scenario).domain
    drawn = {"mass_kg": cell.mass_kg, "friction": cell.friction, "distance_m": cell.distance_m}
    return replace(task, domain=replace(domain, **{part: value for part, value in drawn.items() if value is not None}))


def _final_task(cell: TrainingCell, task: TaskConfig) -> TaskConfig:
    """The task of the further evaluation; `ConfigError` or `ScenarioError` if a part of it cannot be used."""
    if cell.final_ending is not None:
        task = replace(task, ending=load_task(cell.final_ending, task.scenario).ending)
    if cell.final_starts is not None:
        task = replace(task, domain=load_task(cell.final_starts, task.scenario).domain)
    return task if cell.final_scenario is None else replace(task, scenario=load_scenario(cell.final_scenario))


def _profile(cell: TrainingCell) -> AnyProfile:
    """The profile with the values of the cell.

    Raises:
        ConfigError: There is no such profile, or its algorithm has no such setting.
    """
    plain = msgspec.to_builtins(load_profile(cell.profile))
    tables: dict[str, dict[str, Any]] = {
        "": {"steps": cell.steps, "normalize_observation": cell.normalize_observation},
        "network": {"hidden": cell.hidden},
        "settings": {"n_steps": cell.n_steps, "batch_size": cell.batch_size},
    }
    for table, values in tables.items():
        (plain[table] if table else plain).update({name: value for name, value in values.items() if value is not None})
    return read_profile(plain, f"profile {cell.profile}")


def run(cell: ResolvedTraining) -> Mapping[str, Any]:
    """Train to the end, and return the best policy with its evaluation."""
    with temporary_folder("training-") as folder:
        return run_in(cell, folder / "training")


def run_in(cell: ResolvedTraining, folder: Path) -> Mapping[str, Any]:
    """Train in a folder that stays, or go on there from the last checkpoint; see `run`.

    Raises:
        ConfigError: Another training is in the folder, or another program uses it.
    """
    if cell.init is not None:
        require_policy(cell.init, cell.init_sha256)
    worlds = [LocalWorld(new_simulator(cell.world)) for _ in range(cell.n_simulators)]
    best = train_in(folder, plan_of_cell(cell), worlds)
    packed, last = pack(folder / BEST), read_policy(folder / LAST)
    if cell.final_world != cell.world:
        worlds = [LocalWorld(new_simulator(cell.final_world)) for _ in range(cell.n_simulators)]
    return {
        "steps_done": last.card.steps,
        "best_step": best.step,
        "success_rate": best.success_rate,
        "position_error_m": best.position_error_m,
        "angle_error_deg": best.angle_error_deg,
        "falls": best.falls,
        "cycles": best.cycles,
        **of_last(last.card),
        **final_columns(last, cell.final_task, worlds, cell.final_episodes, cell.final_first_seed),
        "policy_zip": packed,
    }


def plan_of_cell(cell: ResolvedTraining) -> TrainingPlan:
    """The plan of the training."""
    return TrainingPlan(
        profile=read_profile(cell.profile, "profile"),
        task=cell.task,
        seed=cell.seed,
        n_simulators=cell.n_simulators,
        command=cell.command,
        versions={name: version for name, version in installed_versions().items() if version is not None},
        world=cell.world,
        init=cell.init,
        loggers=cell.loggers,
        callbacks=cell.callbacks,
        film_every=cell.film_every,
        film_last=cell.film_last,
    )


TRAINING: Final = CellKind(
    specification=TrainingCell,
    run=run,
    run_in=run_in,
    resolved=ResolvedTraining,
    resolve=resolve,
    columns=COLUMNS,
    changes=Scenario,
)
"""The kind of cell."""
