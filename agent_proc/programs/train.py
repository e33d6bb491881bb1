"""Training as a program: `legpush train`."""

import logging
import sys
import threading
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
from rich.console import Console
from rich.text import Text

from agent_proc.learning import training_plan
from agent_proc.learning.plan_file import read_plan, write_plan
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.policies.learning_libraries import learning_libraries
from agent_proc.profiles.profile import load_profile, require_untuned_seeds
from agent_proc.programs.render_films import render_films
from agent_proc.programs.training.plan import begin_of_name, folder_of, plan_of
from agent_proc.programs.training.shown import shown
from agent_proc.simulators import simulators
from agent_proc.studies.seed_trainings import has_seeds
from legpush.errors import INTERRUPTED, ConfigError, DivergedError, LegpushError, is_disk_full
from legpush.fields import parse_seeds
from legpush.files import make_folder, write_whole
from legpush.numerics.computed_with import computed_with, told
from legpush.options.checks import require_writable_folder
from legpush.options.learning import TrainOptions
from legpush.output.reply import document
from legpush.plugins import why_not_loaded
from legpush.runs.folder import COMMAND_FILE, LOGS, own_folder
from legpush.service import run_command, stop_on_signals

if TYPE_CHECKING:
    from agent_proc.learning.training import Training


def main() -> int:
    """Parse the command line and train; returns the exit code."""
    logging.captureWarnings(True)
    return run_command("train", TrainOptions, lambda options: train(options, Console(), sys.argv[1:]))


def train(options: TrainOptions, console: Console, argv: Sequence[str] = ()) -> int:
    """Begin or resume a training; returns 0 if it finished, 130 if it was interrupted.

    `argv` has the words that the options were given with.

    Raises:
        PolicyError: A learning library is not installed.
    """
    with learning_libraries("a training"):
        from agent_proc.learning.checkpoint import CHECKPOINT_FILE
        from agent_proc.learning.loggers.registry import require_tools
    options.require_own_settings(argv)
    if options.seeds is not None or (options.resume is not None and has_seeds(options.resume)):
        return _train_seeds(options, console)
    if options.resume is not None:
        if options.workers is not None:
            raise ConfigError(f"Expected --workers with a training of several seeds alone, got {options.resume}")
        folder, plan = options.resume, read_plan(options.resume)
        require_writable_folder(folder, "--resume")
        require_tools(plan.loggers, plan.callbacks, (*options.loggers, *options.callbacks))
    else:
        require_untuned_seeds(load_profile(options.profile), [options.seed], "--seed")
        plan = plan_of(options)
        folder = folder_of(options, plan.task.entry)
        if options.dry_run:
            sys.stdout.write(msgspec.json.format(msgspec.json.encode(plan), indent=2).decode() + "\n")
            document(plan)
            return 0
        if (n := plan.steps_learned) != plan.profile.steps:
            words = f"{plan.profile.steps} push cycles end within a rollout; it learns from whole ones, from {n}"
            console.print(Text(words), soft_wrap=True)
        _begin(folder, plan, private=options.out is None)
    try:
        return _learn(folder, plan, options, console)
    except (LegpushError, OSError) as error:
        if is_disk_full(error) and (folder / CHECKPOINT_FILE).exists():
            console.print(Text(f"after space is made, to go on: {_again(folder, plan)}"), soft_wrap=True)
        raise


def _train_seeds(options: TrainOptions, console: Console) -> int:
    """Train with several seeds; returns the exit code.

    Raises:
        ConfigError: What studies need is not installed, or an option cannot be used.
    """
    try:
        from agent_proc.programs.training.seeds import begin_seeds, resume_seeds
    except ModuleNotFoundError as error:
        raise ConfigError(f"Expected trainings with several seeds to begin, but {why_not_loaded(error)}") from error
    if options.seeds is None:
        return resume_seeds(options, console)
    seeds = parse_seeds(options.seeds, "--seeds")
    require_untuned_seeds(load_profile(options.profile), seeds, "--seeds")
    plan_of(replace(options, seeds=None, seed=seeds[0]))
    folder = options.out or Path("runs") / f"{begin_of_name(options)}-seeds{options.seeds}"
    return begin_seeds(options, seeds, folder, console)


def _learn(folder: Path, plan: TrainingPlan, options: TrainOptions, console: Console) -> int:
    """Learn in the folder until the training is done or interrupted; returns the exit code."""
    from agent_proc.learning import training
    from agent_proc.learning.vec_env import PushVecEnv

    stop, links_stop = stop_on_signals(), threading.Event()
    options = replace(options, simulators=plan.n_simulators, world=plan.world)
    make_folder(folder / LOGS, private=True)
    write_whole(folder / LOGS / COMMAND_FILE, f"{_again(folder, plan)}\n".encode(), private=True)
    with (
        own_folder(folder),
        simulators(options, folder / LOGS, links_stop, kind="train", folder=folder) as worlds,
        shown(console) as show,
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
        console.print(Text(f"{kept_words(result.step, done)}; to go on: {_again(folder, plan)}"), soft_wrap=True)
        return INTERRUPTED
    if result.ended_by is not None:
        told_end = (
            f"the callback {result.ended_by} ended the training after {result.step} of {plan.profile.steps} steps"
        )
        console.print(Text(told_end), soft_wrap=True)
    console.print(Text(f"best policy, {result.best}: {folder / training.BEST}"), soft_wrap=True)
    is_filmed = render_films(folder, console, _again(folder, plan), stop)
    document({"folder": folder, "policy": folder / training.BEST, "best": result.best, "n_steps": result.step})
    return 0 if is_filmed else INTERRUPTED


def kept_words(n_kept: int, n_done: int) -> str:
    """What an interrupted training keeps: PPO learns from whole rollouts, and an unfinished one is not saved."""
    lost = f"; {n_done - n_kept} more of an unfinished rollout are done again" if n_done > n_kept else ""
    return f"interrupted: {n_kept} steps are kept{lost}"


def _again(folder: Path, plan: TrainingPlan) -> str:
    """The command that goes on with the training in the folder."""
    return training_plan.again(folder, plan.loggers, plan.callbacks)


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


def _begin(folder: Path, plan: TrainingPlan, *, private: bool) -> None:
    """Make the folder with the plan in it; only the user can enter one that is `private`."""
    make_folder(folder, private=private)
    write_plan(folder, plan)
