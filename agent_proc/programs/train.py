"""Training as a program: `legpush train`."""

import logging
import shlex
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import msgspec
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from agent_proc.learning import training_plan
from agent_proc.learning.plan_file import read_plan, write_plan
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.policies.folder import policy_path
from agent_proc.policies.learning_libraries import learning_libraries
from agent_proc.profiles.profile import load_profile, require_untuned_seeds
from agent_proc.programs.render_films import render_films
from agent_proc.simulators import MAP_SUFFIX, require_world, simulators
from agent_proc.studies.seed_trainings import has_seeds
from agent_proc.task.file import load_task
from agent_proc.task.rooms import refuse_missions
from legpush.errors import INTERRUPTED, ConfigError, DivergedError, LegpushError, is_disk_full
from legpush.fields import parse_seeds
from legpush.files import make_folder, write_whole
from legpush.numerics.computed_with import computed_with, told
from legpush.options.checks import require_writable_folder
from legpush.options.learning import TrainOptions
from legpush.options.scenarios import changed_scenario
from legpush.output.reply import document
from legpush.output.screen import can_draw_over
from legpush.plugins import why_not_loaded
from legpush.runs.folder import COMMAND_FILE, LOGS, own_folder
from legpush.scenarios.changes import override, parse_changes
from legpush.scene.scenario import Scenario
from legpush.service import run_command, stop_on_signals
from legpush.versions import installed_versions

if TYPE_CHECKING:
    from agent_proc.learning.training import Training


def main() -> int:
    """Parse the command line and train; returns the exit code."""
    logging.captureWarnings(True)
    return run_command("train", TrainOptions, lambda options: train(options, Console()))


def train(options: TrainOptions, console: Console) -> int:
    """Begin or resume a training; returns 0 if it finished, 130 if it was interrupted.

    Raises:
        PolicyError: A learning library is not installed.
    """
    with learning_libraries("a training"):
        from agent_proc.learning.checkpoint import CHECKPOINT_FILE
        from agent_proc.learning.loggers.registry import require_tools
    options.require_own_settings()
    if options.seeds is not None or (options.resume is not None and has_seeds(options.resume)):
        return _train_seeds(options, console)
    if options.resume is not None:
        folder, plan = options.resume, read_plan(options.resume)
        require_writable_folder(folder, "--resume")
        require_tools(plan.loggers, plan.callbacks, (*options.loggers, *options.callbacks))
    else:
        folder, plan = _plan(options)
        if options.dry_run:
            sys.stdout.write(msgspec.json.format(msgspec.json.encode(plan), indent=2).decode() + "\n")
            document(plan)
            return 0
        _begin(folder, plan, private=options.out is None)
    try:
        return _learn(folder, plan, options, console)
    except (LegpushError, OSError) as error:
        if is_disk_full(error) and (folder / CHECKPOINT_FILE).exists():
            console.print(Text(f"after space is made, to go on: {_again(folder)}"), soft_wrap=True)
        raise


def _train_seeds(options: TrainOptions, console: Console) -> int:
    """Train with several seeds; returns the exit code.

    Raises:
        ConfigError: What studies need is not installed, or an option cannot be used.
    """
    try:
        from agent_proc.programs.train_seeds import begin_seeds, resume_seeds
    except ModuleNotFoundError as error:
        raise ConfigError(f"Expected trainings with several seeds to begin, but {why_not_loaded(error)}") from error
    if options.seeds is None:
        return resume_seeds(options, console)
    seeds = parse_seeds(options.seeds, "--seeds")
    profile = load_profile(options.profile)
    require_untuned_seeds(profile, seeds, "--seeds")
    refuse_missions(load_task(options.task or profile.task).random_room)
    folder = options.out or Path("runs") / f"{_name(options)}-seeds{options.seeds}"
    return begin_seeds(options, seeds, folder, console)


def _learn(folder: Path, plan: TrainingPlan, options: TrainOptions, console: Console) -> int:
    """Learn in the folder until the training is done or interrupted; returns the exit code."""
    from agent_proc.learning import training
    from agent_proc.learning.vec_env import PushVecEnv

    stop, links_stop = stop_on_signals(), threading.Event()
    options = replace(options, simulators=plan.n_simulators, world=plan.world)
    make_folder(folder / LOGS, private=True)
    write_whole(folder / LOGS / COMMAND_FILE, f"{_again(folder)}\n".encode(), private=True)
    with (
        own_folder(folder),
        simulators(options, folder / LOGS, links_stop, kind="train", folder=folder) as worlds,
        _shown(console) as show,
    ):
        env, done = PushVecEnv(plan.task, worlds, stop=links_stop), 0

        def on_progress(progress: training_plan.Progress) -> None:
            nonlocal done
            done = progress.step
            show(progress)

        try:
            job = training.Training(plan, folder, env, worlds, stop=stop, on_progress=on_progress)
            if options.resume is not None:
                _resume(job, plan)
            result = job.run()
        finally:
            env.close()
    if not result.finished:
        console.print(Text(f"{kept_words(result.step, done)}; to go on: {_again(folder)}"), soft_wrap=True)
        return INTERRUPTED
    console.print(Text(f"best policy, {result.best}: {folder / training.BEST}"), soft_wrap=True)
    render_films(folder, console)
    document({"folder": folder, "policy": folder / training.BEST, "best": result.best, "n_steps": result.step})
    return 0


def kept_words(n_kept: int, n_done: int) -> str:
    """What an interrupted training keeps: PPO learns from whole rollouts, and an unfinished one is not saved."""
    lost = f"; {n_done - n_kept} more of an unfinished rollout are done again" if n_done > n_kept else ""
    return f"interrupted: {n_kept} steps are kept{lost}"


def _again(folder: Path) -> str:
    """The command that goes on with the training in the folder."""
    return shlex.join(["legpush", "train", "--resume", str(folder)])


def _resume(job: "Training", plan: TrainingPlan) -> None:
    """Continue from the last checkpoint.

    Raises:
        DivergedError: The simulators compute something else than before; says so if the numerics are others.
        OtherVersionError: The training is of another version, whose motions were others.
    """
    try:
        job.resume()
    except DivergedError as error:
        still = "the training cannot go on here, its best policy can be used; train again in another folder"
        raise told(error, computed_with(plan.versions), still) from error


def _plan(options: TrainOptions) -> tuple[Path, TrainingPlan]:
    """Make the plan from the options, and choose a folder that can be made.

    Raises:
        ConfigError: An option cannot be used.
        PolicyError: There is no policy to begin with.
        PluginError: There is no such world.
    """
    from agent_proc.learning.loggers.registry import require_tools

    profile = load_profile(options.profile)
    require_world(options.world)
    if options.init is not None:
        policy_path(options.init)
    require_untuned_seeds(profile, [options.seed], "--seed")
    require_tools(options.loggers, options.callbacks, (*options.loggers, *options.callbacks))
    if options.steps is not None:
        profile = msgspec.structs.replace(profile, steps=options.steps)
    task = load_task(
        options.task or profile.task,
        _scenario(options, profile.task),
        **_given(entry=options.entry, action_form=options.actions),
        domain=_given(mass_kg=options.mass_kg, friction=options.friction, distance_m=options.distance_m),
    )
    refuse_missions(task.random_room)
    plan = TrainingPlan(
        profile=profile,
        task=task,
        seed=options.seed,
        n_simulators=options.n_simulators,
        command=shlex.join(["legpush", "train", *sys.argv[1:]]),
        versions={name: version for name, version in installed_versions().items() if version is not None},
        world=str(Path(options.world).absolute()) if options.world.endswith(MAP_SUFFIX) else options.world,
        init=options.init,
        loggers=options.loggers,
        callbacks=options.callbacks,
        film_every=options.film_every,
        film_last=options.film_last,
    )
    folder = options.out or Path("runs") / f"{_name(options)}-{task.entry}-seed{options.seed}"
    require_writable_folder(folder, "--out")
    if folder.exists() and any(folder.iterdir()):
        raise ConfigError(f"Expected a new or empty folder for --out, got {folder}; --resume {folder} goes on in it")
    return folder, plan


def _begin(folder: Path, plan: TrainingPlan, *, private: bool) -> None:
    """Make the folder with the plan in it; only the user can enter one that is `private`."""
    make_folder(folder, private=private)
    write_plan(folder, plan)


def _scenario(options: TrainOptions, task: str) -> Scenario | None:
    """The scenario that replaces that of the task, or None."""
    if options.scenario is not None:
        return changed_scenario(options.scenario, options.changes)
    if not options.changes:
        return None
    return override(load_task(options.task or task).scenario, parse_changes(options.changes), "--set")


def _name(options: TrainOptions) -> str:
    """Begin of the name of a folder that is not given."""
    return f"{datetime.now().astimezone():%Y%m%d-%H%M%S}-train-{Path(options.profile).stem}"


def _given(**values: Any) -> dict[str, Any]:
    """The values that are not None."""
    return {name: value for name, value in values.items() if value is not None}


N_LINES: Final = 20
"""Number of lines of progress if there is no terminal to draw a bar on."""


@contextmanager
def _shown(console: Console) -> Iterator[Any]:
    """A progress bar with return, success rate and remaining time, or plain lines without a terminal."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[numbers]}", markup=False),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    best: list[object] = [None]
    lines = 0
    with Progress(*columns, console=console, disable=not can_draw_over(console)) as bar:
        task = bar.add_task("learning", total=None, numbers="")

        def show(progress: training_plan.Progress) -> None:
            nonlocal lines
            numbers = f"{progress.step}/{progress.steps}"
            if progress.mean_return is not None and progress.success_rate is not None:
                numbers += f", return {progress.mean_return:.2f}, success {progress.success_rate:.0%}"
            bar.update(task, description=progress.doing, completed=progress.step, total=progress.steps, numbers=numbers)
            if not can_draw_over(console) and N_LINES * progress.step // progress.steps > lines:
                lines = N_LINES * progress.step // progress.steps
                console.print(Text(f"{progress.doing} {numbers}"), soft_wrap=True)
            if progress.best is not None and progress.best is not best[0]:
                best[0] = progress.best
                console.print(Text(f"step {progress.best.step}: {progress.best}"), soft_wrap=True)

        yield show
