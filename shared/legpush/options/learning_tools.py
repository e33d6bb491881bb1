"""Options of the tools around training: `legpush compare`, `curves` and `tune`."""

import os
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated, Final, Literal

from legpush.arguments import USUAL_OUTPUT, OutputOptions, Positional, Repeated, arg
from legpush.bounds import Amount, BoxMass, Friction, Length, Simulators
from legpush.errors import ConfigError
from legpush.fields import Seed, parse_seeds, require, require_seeds
from legpush.options.checks import require_picture_ending
from legpush.options.learning import DEFAULT_WORLD, default_simulators
from legpush.options.scenarios import Changes

FIRST_TUNING_SEED: Final = 3_000_000
"""First of the starts by which settings are chosen."""
FIRST_HELD_OUT_SEED: Final = 5_000_000
"""First of the starts on which policies are compared: nothing else uses them."""

SCENARIO: Final = "push"


def usual_workers() -> int:
    """Return the default number of worker processes: one per core that this process may use."""
    return len(os.sched_getaffinity(0))


def dated(command: str) -> Path:
    """Return the default folder of a command that begins now."""
    return Path("runs") / f"{datetime.now().astimezone():%Y%m%d-%H%M%S}-{command}"


@dataclass(frozen=True, kw_only=True)
class CompareOptions:
    """Compare trainings and policies on equal held-out starts, beside the dumbest rivals: zero, random, best constant.

    A RUN is the folder of trainings with several seeds or of a single training, a policy folder, the name of a
    policy, or that of a rival: alternate, bang_bang, script, script_over_map, dynamic_programming, look_ahead,
    look_ahead_by_physics or search. Each number has its 95 % interval over trainings and starts; differences are
    paired. It is a study: the same command with the same --out goes on after an interruption. Exit codes: 0
    compared, 2 bad input, 3 a cell failed, 130 interrupted.
    """

    runs: Positional[Annotated[tuple[str, ...], arg("RUN ...")]]
    """Trainings or policies."""
    policy: Annotated[Literal["best", "last"], arg()] = "best"
    """Which policy of each training."""
    against: Annotated[str, arg("NAME")] = "constant"
    """The others are compared with this one: a rival, or the name of a RUN as the table shows it."""
    episodes: Annotated[int, arg("N")] = 50
    """Number of starts, for each swept value."""
    seed: Annotated[int, arg("N")] = FIRST_HELD_OUT_SEED
    """Seed of the first start; each later one has the next seed."""
    scenario: Annotated[str | None, arg("NAME|FILE")] = None
    """Scenario with the robot ready to push, and the goal with its tolerances; `push`, or that of --task, if not given.
    """
    changes: Changes = ()
    """Change a field of the scenario, such as room.slope_deg=3; may be given several times."""
    task: Annotated[str | None, arg("NAME|FILE")] = None
    """Task, such as the level push-l1 of the benchmark: its scenario, what each start draws, and the actions and the
    stop rule of the rivals. If not given, these are of the first RUN that is a policy folder."""
    domain: Annotated[str | None, arg("NAME|FILE")] = None
    """Task, or its file, whose domain and tolerances replace those of the scenario: each start draws its own box and
    goal."""
    sweep: Annotated[Repeated[str], arg("FIELD=VALUE,...")] = ()
    """A field of the scenario and its values, such as box.mass_kg=0.1,0.5,0.9; given again, all combinations."""
    world: Annotated[str, arg("NAME")] = DEFAULT_WORLD
    """What is pushed in: `mujoco`, the simulator; `map`, a map of the default box without physics; another plug-in."""
    search_world: Annotated[str, arg("NAME")] = "map"
    """What the best constant is searched in, on starts of its own: 426 episodes with variable entry. `map` knows the
    default box alone."""
    workers: Annotated[int | None, arg("N")] = None
    """Number of worker processes; if not given, one per core."""
    out: Annotated[Path | None, arg("DIR")] = None
    """Folder for comparison.json, comparison.csv, comparison.png and the studies; `runs/<time>-compare` if not
    given."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        if not self.runs:
            raise ConfigError("Expected at least one RUN: a training, a policy folder, or the name of a policy")
        if self.task is not None and self.domain is not None:
            raise ConfigError("Expected either --task, which has a domain, or --domain, got both")
        require(Amount, self.episodes, "--episodes")
        require(Amount, self.workers, "--workers")
        require_seeds(self.seed, self.episodes, "--seed")

    @property
    def n_workers(self) -> int:
        """Number of worker processes."""
        return self.workers if self.workers is not None else usual_workers()


@dataclass(frozen=True, kw_only=True)
class TuneOptions:
    """Search the settings of a training profile: trials with several seeds each, and bad ones given up after a few.

    The best settings are written as a profile that `legpush train --profile FILE` takes. Ctrl-C keeps every finished
    training; the same command with the same --out goes on, to the same trials. Needs `legpush[tune]`. Exit codes: 0
    tuned, 2 bad input, 3 a training failed, 130 interrupted.
    """

    profile: Annotated[str, arg("NAME|FILE")] = "tuned"
    """Training profile whose settings are searched; the first trial has its own, if they are in the space."""
    space: Annotated[str | None, arg("NAME|FILE")] = None
    """Search space: ppo, sac, td3, or the path of a TOML file; that of the profile's algorithm if not given."""
    trials: Annotated[int, arg("N")] = 40
    """Number of trials."""
    seeds: Annotated[str, arg("N-M,...")] = "1001-1003"
    """Training seeds of each trial. The profile notes them, and `legpush train` refuses them."""
    batch: Annotated[int, arg("N")] = 4
    """Trials that are chosen at a time, by all earlier ones; the result depends on it, and not on --workers."""
    sampler: Annotated[Literal["tpe", "random"], arg()] = "tpe"
    """How values are chosen: by a tree-structured Parzen estimator, or at random."""
    pruner: Annotated[Literal["median", "none"], arg()] = "median"
    """When a trial is given up: if its mean loss over its seeds up to now is above the median of the finished trials
    with as many, or never."""
    seed: Annotated[int, arg("N")] = 0
    """Seed of the sampler."""
    episodes: Annotated[int, arg("N")] = 30
    """Starts from which the last policy of each training is judged."""
    first_seed: Annotated[int, arg("N")] = FIRST_TUNING_SEED
    """Seed of the first of these starts. The profile notes them, and `legpush compare` refuses them."""
    task: Annotated[str | None, arg("NAME|FILE")] = None
    """Replaces the profile's task."""
    entry: Annotated[Literal["fixed", "variable"] | None, arg()] = None
    """Replaces the task's depth of the pushes."""
    scenario: Annotated[str | None, arg("NAME|FILE")] = None
    """Replaces the task's scenario."""
    changes: Changes = ()
    """Change a field of the scenario, such as room.slope_deg=3; may be given several times."""
    steps: Annotated[int | None, arg("N")] = None
    """Replaces the profile's number of push cycles."""
    mass_kg: Annotated[tuple[float, float] | None, arg("LOW HIGH")] = None
    """Draw the mass of the box for each episode of a training."""
    friction: Annotated[tuple[float, float] | None, arg("LOW HIGH")] = None
    """Draw the friction of the box for each episode of a training."""
    distance_m: Annotated[tuple[float, float] | None, arg("LOW HIGH")] = None
    """Draw the distance from box to goal for each episode of a training."""
    world: Annotated[str, arg("NAME")] = "map"
    """What is pushed in: `map`, a map of the default box without physics; `mujoco`, the simulator; another plug-in."""
    simulators: Annotated[int | None, arg("N")] = None
    """Number of simulators or other worlds of a training; if not given, one per core, 8 at most."""
    workers: Annotated[int | None, arg("N")] = None
    """Number of trainings at a time; if not given, one per core."""
    out: Annotated[Path | None, arg("DIR")] = None
    """Folder for best.toml, trials.csv, tuning.png, the database of Optuna and the studies; `runs/<time>-tune` if not
    given."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        parse_seeds(self.seeds, "--seeds")
        for value, flag in ((self.trials, "--trials"), (self.batch, "--batch"), (self.episodes, "--episodes")):
            require(Amount, value, flag)
        require(Amount, self.steps, "--steps")
        require(Amount, self.workers, "--workers")
        require(Seed, self.seed, "--seed")
        require(Simulators, self.simulators, "--simulators")
        require_seeds(self.first_seed, self.episodes, "--first-seed")
        for kind, interval, flag in (
            (BoxMass, self.mass_kg, "--mass-kg"),
            (Friction, self.friction, "--friction"),
            (Length, self.distance_m, "--distance-m"),
        ):
            for bound in interval or ():
                require(kind, bound, flag)

    @property
    def n_workers(self) -> int:
        """Number of worker processes."""
        return self.workers if self.workers is not None else usual_workers()

    @property
    def n_simulators(self) -> int:
        """Number of worlds of a training."""
        return self.simulators if self.simulators is not None else default_simulators()


@dataclass(frozen=True, kw_only=True)
class CurvesOptions:
    """Draw learning curves of trainings: of each seed, and the mean over the seeds with its 95 % interval.

    Exit codes: 0 drawn, 2 bad input.
    """

    runs: Positional[Annotated[tuple[str, ...], arg("RUN ...")]]
    """Folders of trainings with several seeds, of single trainings, or of policies."""
    out: Annotated[Path, arg("FILE")] = Path("curves.png")
    """The new picture: .png, .svg or .pdf."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        if not self.runs:
            raise ConfigError("Expected at least one RUN: the folder of a training")
        require_picture_ending(self.out, "--out")
