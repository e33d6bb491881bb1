"""Tuning as a program: `legpush tune`."""

import os
import shlex
import sys
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import msgspec
import numpy as np
import tomli_w
from rich.console import Console
from rich.text import Text

from agent_proc.evaluation.loss import episode_loss
from agent_proc.profiles.profile import AnyProfile, TunedOn, dump_profile, load_profile
from agent_proc.programs.training.plan import plan_of
from agent_proc.studies.rows_of_study import rows_of_study
from agent_proc.studies.tuning.space import Space, Value, load_space
from legpush.arguments import words
from legpush.errors import ConfigError
from legpush.fields import parse_seeds
from legpush.files import make_folder, write_whole
from legpush.options.checks import require_writable_folder
from legpush.options.learning import TrainOptions
from legpush.options.learning_tools import TuneOptions, dated
from legpush.output.reply import document
from legpush.plugins import why_not_loaded
from legpush.scenarios.changes import parse_changes
from legpush.scene.scenario import Goal
from legpush.service import run_command, stop_on_signals
from legpush.study.carry_out import Orders
from legpush.study.engines.local import LocalEngine
from legpush.study.engines.staying import staying
from legpush.study.file import read_study

if TYPE_CHECKING:
    from agent_proc.studies.tuning.trials import TrialEnd, Trials

SETTINGS_FILE: Final = "tuning.json"
"""What a tuning is: another one does not go on in its folder."""
RESULTS: Final = ("final_ended", "final_position_error_m", "final_angle_error_deg")


def main() -> int:
    """Parse the command line and tune; returns the exit code."""
    return run_command("tune", TuneOptions, lambda options: tune(options, Console()))


def tune(options: TuneOptions, console: Console) -> int:
    """Run all trials, or go on with them, and write the best profile; returns the exit code.

    Raises:
        ConfigError: An option cannot be used, the folder has another tuning, or Optuna is not installed.
        StopRequestedError: Interrupted by a signal; what is done is kept.
        LegpushError: A training failed.
    """
    try:
        from agent_proc.studies.tuning.trials import Trials
    except ModuleNotFoundError as error:
        raise ConfigError(f"Expected a tuning to begin, but {why_not_loaded(error)}") from error
    folder, seeds = options.out or dated("tune"), parse_seeds(options.seeds, "--seeds")
    require_writable_folder(folder, "--out")
    profile = _searched(options)
    space = load_space(options.space, profile)
    goal = plan_of(_training(options)).task.scenario.goal
    _begin(folder, options, space)
    trials = Trials(
        folder,
        space,
        seed=options.seed,
        batch=options.batch,
        n_seeds=len(seeds),
        pruner=options.pruner,
        sampler=options.sampler,
    )
    again = [*sys.argv[1:], *([] if options.out else ["--out", str(folder)])]
    with staying(LocalEngine(options.n_workers)) as engine:
        orders = Orders(
            engine=lambda _: engine,
            stop=stop_on_signals(),
            again=shlex.join(["legpush", "tune", *again]),
            retry_failed=True,
        )

        def judge(values: Mapping[int, Mapping[str, Value]], place: int) -> dict[int, float]:
            return _losses(options, space, goal, folder, orders, values, seeds[place])

        trials.run(options.trials, judge, partial(_tell, trials, console))
    tuned_on = TunedOn(training_seeds=seeds, first_start=options.first_seed, n_starts=options.episodes)
    _report(trials, space, tuned_on, folder, options, console)
    return 0


def _searched(options: TuneOptions) -> AnyProfile:
    """The profile whose settings are searched, with the steps and the task of the options."""
    profile = load_profile(options.profile)
    task = _path_or_name(options.task or profile.task)
    return msgspec.structs.replace(profile, task=task, steps=options.steps or profile.steps, tuned_on=None)


def _begin(folder: Path, options: TuneOptions, space: Space) -> None:
    """Write what the tuning is into its folder, or see that it is there.

    Raises:
        ConfigError: The folder has another tuning, or something else.
    """
    free = ("out", "workers", "trials", "output")
    plain = {name: value for name, value in vars(options).items() if name not in free}
    about = {**plain, "simulators": options.n_simulators, "space": space.parameters, "profile": space.profile}
    text = msgspec.json.format(msgspec.json.encode(about), indent=1) + b"\n"
    file = folder / SETTINGS_FILE
    make_folder(folder, private=options.out is None)
    if not file.exists():
        if any(folder.iterdir()):
            raise ConfigError(f"Expected a new or empty folder for --out, or that of this tuning, got {folder}")
        (folder / "profiles").mkdir()
        write_whole(file, text)
    elif file.read_bytes() != text:
        there, now = msgspec.json.decode(file.read_bytes()), msgspec.json.decode(text)
        changed = [name for name in now if there.get(name) != now[name]]
        raise ConfigError(f"{folder}: expected the folder of this tuning, got one with other {', '.join(changed)}")


def _losses(
    options: TuneOptions,
    space: Space,
    goal: Goal,
    folder: Path,
    orders: Orders,
    values: Mapping[int, Mapping[str, Value]],
    seed: int,
) -> dict[int, float]:
    """Train each trial with a seed, and return its mean loss over the tuning starts."""
    paths = {number: folder / "profiles" / f"trial-{number:04}.toml" for number in values}
    for number, path in paths.items():
        write_whole(path, dump_profile(space.profile_with(values[number])).encode())
    settings = {
        "entry": options.entry,
        "scenario": options.scenario if options.scenario is None else _path_or_name(options.scenario),
        "mass_kg": options.mass_kg,
        "friction": options.friction,
        "distance_m": options.distance_m,
        "world": options.world,
        "n_simulators": options.n_simulators,
        "final_episodes": options.episodes,
        "final_first_seed": options.first_seed,
        "seed": seed,
        **parse_changes(options.changes),
    }
    name = f"trials-{min(values):04}-seed-{seed}"
    file: dict[str, Any] = {
        "name": name,
        "cell": "training",
        "results": list(RESULTS),
        "settings": {key: value for key, value in settings.items() if value is not None},
        "axes": {"profile": [str(path.absolute()) for path in paths.values()]},
    }
    rows = rows_of_study(read_study(tomli_w.dumps(file), name), folder / "studies" / name, orders)
    return {number: _loss(row, goal) for number, row in zip(values, rows, strict=True)}


def _path_or_name(text: str) -> str:
    return os.path.abspath(text) if Path(text).is_file() else text


def _loss(row: Mapping[str, Any], goal: Goal) -> float:
    columns = (row[name] for name in RESULTS)
    losses = [
        episode_loss(ended == "done", position_m, angle_deg, goal)
        for ended, position_m, angle_deg in zip(*columns, strict=True)
    ]
    return float(np.mean(losses))


def _tell(trials: "Trials", console: Console, end: "TrialEnd") -> None:
    """Print how a trial ended."""
    best = trials.best
    n_seeds = f"{end.n_seeds} seed{'s' if end.n_seeds > 1 else ''}{', given up' if end.pruned else ''}"
    known = "" if best is None else f"; best {best.loss:.3f} of trial {best.number}"
    console.print(Text(f"trial {end.number}: loss {end.loss:.3f} ({n_seeds}){known}"), soft_wrap=True)


def _report(
    trials: "Trials", space: Space, tuned_on: TunedOn, folder: Path, options: TuneOptions, console: Console
) -> None:
    """Write the best profile, the table and the picture, and say which they are.

    Raises:
        ConfigError: No trial had all seeds.
    """
    from agent_proc.studies.tuning.report import save_picture, write_best, write_trials

    best, ends = trials.best, trials.ended
    if best is None:
        raise ConfigError("Expected a trial with all seeds, got none: give more --trials")
    for path, value in best.values.items():
        console.print(Text(f"  {path} = {value:.4g}" if isinstance(value, float) else f"  {path} = {value}"))
    if ends[0].values == space.values_of_profile():
        console.print(Text(f"loss {best.loss:.3f}; that of the profile itself, trial 0: {ends[0].loss:.3f}"))
    console.print(Text("the best of many is too low by chance: judge it on other seeds and starts"), soft_wrap=True)
    profile = write_best(folder, space, best, tuned_on)
    written = (profile, write_trials(folder, space, ends), save_picture(folder, space, ends))
    console.print(Text(f"wrote {', '.join(map(str, written))}"), soft_wrap=True)
    document({"folder": folder, "profile": profile, "best": best, "trials": ends})
    command = replace(_training(options), profile=str(profile), task=None, steps=None, seeds="1-5")
    console.print(Text(shlex.join(["legpush", "train", *words(command)])), soft_wrap=True)


def _training(options: TuneOptions) -> TrainOptions:
    """A training of the tuning."""
    return TrainOptions(
        profile=options.profile,
        task=options.task,
        entry=options.entry,
        scenario=options.scenario,
        changes=options.changes,
        steps=options.steps,
        mass_kg=options.mass_kg,
        friction=options.friction,
        distance_m=options.distance_m,
        world=options.world,
        simulators=options.simulators,
    )
