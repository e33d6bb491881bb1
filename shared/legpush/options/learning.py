"""Options of `legpush train`, `evaluate` and `calibrate`."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Final, Literal

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, Repeated, arg
from legpush.bounds import MAX_DEPTH_M, Amount, BoxMass, Friction, Length, Simulators
from legpush.bus.endpoints import require_alone
from legpush.errors import ConfigError
from legpush.fields import Seed, parse_seeds, require, require_seeds
from legpush.messages.common import USUAL_DEPTH_M
from legpush.options.checks import require_new_file
from legpush.options.scenarios import Changes, ScenarioName

DEFAULT_WORLD: Final = "mujoco"
"""The simulators, which are processes."""
SERIES_DEPTHS_M: Final = (0.01, 0.02, 0.03, 0.05, 0.08, 0.12)
SERIES_CURVES: Final = (0.5,)
N_SERIES: Final = 2
USUAL_SIMULATORS: Final = 8
"""Most simulators to start by default."""


def default_simulators() -> int:
    """Return the default number of simulators: one per core that this process may use, 8 at most."""
    return min(len(os.sched_getaffinity(0)), USUAL_SIMULATORS)


@dataclass(frozen=True, kw_only=True)
class SimulatorOptions:
    """The simulators to use."""

    world: Annotated[str, arg("NAME|FILE")] = DEFAULT_WORLD
    """What is pushed in: `mujoco`, the simulators; `map`, a map of the default box without physics, about a hundred
    times as fast; `map_mean`, the same without its scatter; `map_unknown`, a box without physics that each episode
    draws; another plug-in; or the path of a map that `legpush calibrate --random-pushes` wrote. All but `mujoco` run in
    the process of the command."""
    simulators: Annotated[int | None, arg("N")] = None
    """Number of simulators or other worlds; if not given, one per core, 8 at most."""
    join: Annotated[str | None, arg("RUN")] = None
    """Join the running simulators of this run instead of starting some."""
    listen: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """With --join: endpoints to listen on for the simulators."""
    connect: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """With --join: endpoints on which the simulators listen."""
    router: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """With --join: endpoints of routers (`legpush router`) through which the simulators are reached."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """With --join: folder of this host that `legpush secure init` made; talk over TLS alone, as an agent."""
    record: Annotated[Path | None, arg("FILE")] = None
    """Record all messages into this new MCAP file; see `legpush replay`."""

    def __post_init__(self) -> None:
        require(Simulators, self.simulators, "--simulators")
        if self.join is None and (self.listen or self.connect or self.router):
            raise ConfigError(
                "Expected --join RUN with --listen, --connect and --router: they say where its simulators are"
            )
        require_alone(self.router, (*self.listen, *self.connect))
        if self.join is None and self.secure is not None:
            raise ConfigError(
                "Expected --join RUN with --secure: simulators that this command starts are reached by its user alone"
            )
        if self.world != DEFAULT_WORLD and (self.join is not None or self.record is not None):
            raise ConfigError(
                f"Expected --world {DEFAULT_WORLD} with --join and --record: {self.world} is no process on a bus"
            )
        if self.join is not None and self.record is not None:
            raise ConfigError("Expected either --join or --record, got both; `legpush record` records a live run")
        if self.record is not None:
            require_new_file(self.record, "--record")

    @property
    def n_simulators(self) -> int:
        """Number of simulators to use."""
        return self.simulators if self.simulators is not None else default_simulators()


SETTINGS: Final = (
    *("profile", "task", "entry", "actions", "seed", "scenario", "changes", "steps"),
    *("mass_kg", "friction", "distance_m", "world", "simulators", "init", "film_every", "film_last", "dry_run"),
)
"""Options of a training that its folder keeps."""


@dataclass(frozen=True, kw_only=True)
class TrainOptions(SimulatorOptions):
    """Train a policy: start simulators, learn, evaluate now and then, keep the best policy.

    Ctrl-C leaves a checkpoint. `--resume DIR` continues from it, to the same weights as a training without a stop.
    Exit codes: 0 trained, 2 bad input, 3 a simulator failed, 130 interrupted.
    """

    profile: Annotated[str, arg("NAME|FILE")] = "tuned"
    """Training profile: tuned, paper-text, paper-observation, paper-learns, release, sac, td3, or the path of a profile
    file."""
    task: Annotated[str | None, arg("NAME|FILE")] = None
    """Replaces the profile's task: tuned, wide, push-l1, push-l2, push-l3, paper-text, paper-observation, paper-learns,
    release, or the path of a task file. push-l4 is learned in its Gymnasium environment instead."""
    entry: Annotated[Literal["fixed", "variable"] | None, arg()] = None
    """Replaces the task's depth of the pushes: the same for all, or chosen by the policy."""
    actions: Annotated[Literal["continuous", "discrete"] | None, arg()] = None
    """Replaces the task's form of the action; `discrete` is the published grid of w1, w2 and leg."""
    seed: Annotated[int, arg("N")] = 0
    """Seed of initial weights, exploration and initial conditions."""
    seeds: Annotated[str | None, arg("N-M,...")] = None
    """Train once with each of these seeds instead, such as 1-5 or 1,3,7: in folders of their own below --out, in this
    process's workers, with a summary over the seeds. The same command, or --resume, goes on after an interruption."""
    workers: Annotated[int | None, arg("N")] = None
    """With --seeds: number of trainings at a time; if not given, one per core."""
    scenario: Annotated[str | None, arg("NAME|FILE")] = None
    """Replaces the task's scenario, which has the robot ready to push, and the goal."""
    changes: Changes = ()
    """Change a field of the scenario, such as room.slope_deg=3; may be given several times."""
    steps: Annotated[int | None, arg("N")] = None
    """Replaces the profile's number of push cycles."""
    mass_kg: Annotated[tuple[float, float] | None, arg("LOW HIGH")] = None
    """Draw the mass of the box for each episode."""
    friction: Annotated[tuple[float, float] | None, arg("LOW HIGH")] = None
    """Draw the friction of the box for each episode."""
    distance_m: Annotated[tuple[float, float] | None, arg("LOW HIGH")] = None
    """Draw the distance from box to goal for each episode."""
    init: Annotated[str | None, arg("POLICY|DIR")] = None
    """Begin with the actor of this trained policy instead of random weights, or with actor and critics of the training
    in this folder."""
    loggers: Annotated[tuple[str, ...], arg("NAME ...")] = ("tensorboard",)
    """Where the numbers of the training are logged: tensorboard, csv (log.csv), wandb (Weights & Biases, offline), or
    those of other packages by name."""
    callbacks: Annotated[tuple[str, ...], arg("NAME ...")] = ()
    """Callbacks of other packages by name."""
    film_every: Annotated[int | None, arg("N")] = None
    """Film an episode of every N-th evaluation; below `films` in the folder of the training."""
    film_last: Flag = False
    """Film an episode of the last evaluation."""
    out: Annotated[Path | None, arg("DIR")] = None
    """Folder of the training; `runs/<time>-train-<profile>-<entry>-seed<N>` if not given."""
    resume: Annotated[Path | None, arg("DIR")] = None
    """Continue the training in this folder, or those of several seeds, with their own settings."""
    dry_run: Flag = False
    """Check the options, print the task with its scenario, and start nothing."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Seed, self.seed, "--seed")
        require(Amount, self.steps, "--steps")
        require(Amount, self.workers, "--workers")
        require(Amount, self.film_every, "--film-every")
        if self.world.startswith("map") and (self.film_every is not None or self.film_last):
            raise ConfigError(f"Expected --world {DEFAULT_WORLD} with --film-every and --film-last: a map has no robot")
        if self.seeds is not None:
            self._check_seeds(self.seeds)
        elif self.workers is not None and self.resume is None:
            raise ConfigError("Expected --seeds with --workers, which says how many trainings run at a time")
        for kind, interval, flag in (
            (BoxMass, self.mass_kg, "--mass-kg"),
            (Friction, self.friction, "--friction"),
            (Length, self.distance_m, "--distance-m"),
        ):
            for value in interval or ():
                require(kind, value, flag)
        if self.resume is not None and self.out is not None:
            raise ConfigError("Expected either --resume DIR, which continues in its folder, or --out DIR, got both")

    def require_own_settings(self, argv: Sequence[str] = ()) -> None:
        """Require that a training that goes on gets none of its settings again, since it keeps them.

        `argv` has the flags of options that are given with their default values.

        Raises:
            ConfigError: An option is given that it would ignore.
        """
        words = {word.partition("=")[0].replace("_", "-") for word in argv}
        flags = {name: "--set" if name == "changes" else f"--{name.replace('_', '-')}" for name in SETTINGS}
        usual = {field.name: field.default for field in fields(self)}
        given = [flag for name, flag in flags.items() if getattr(self, name) != usual[name] or flag in words]
        if self.resume is not None and given:
            raise ConfigError(
                f"Expected --resume DIR, which continues a training with its own settings, without {', '.join(given)}"
            )

    def _check_seeds(self, seeds: str) -> None:
        parse_seeds(seeds, "--seeds")
        if self.resume is not None:
            raise ConfigError("Expected either --resume DIR, which knows its seeds, or --seeds, got both")
        if self.seed != 0:
            raise ConfigError(f"Expected either --seed or --seeds, got --seed {self.seed} and --seeds {seeds}")
        if self.join is not None or self.record is not None:
            raise ConfigError(
                "Expected no --join and no --record with --seeds: its simulators are no processes on a bus"
            )


@dataclass(frozen=True, kw_only=True)
class EvaluateOptions(SimulatorOptions):
    """Evaluate a policy: run episodes from seeded initial conditions, and report errors with 95 % intervals.

    Exit codes: 0 evaluated, 2 bad input, 3 a simulator failed, 130 interrupted.
    """

    policy: Positional[Annotated[str, arg("POLICY")]]
    """The policy: scripted, dynamic_programming, the name of a shipped policy, a policy folder, a model file (.zip) of
    Stable-Baselines3, or module:factory for a policy of your own."""
    normalizer: Annotated[Path | None, arg("FILE")] = None
    """With a model file: the file of `VecNormalize.save`, if the training normalized observations."""
    trust_policy_file: Flag = False
    """Load the model file and its normalizer. They are pickles: loading one runs any code in it."""
    episodes: Annotated[int, arg("N")] = 20
    """Number of episodes for each swept value."""
    seed: Annotated[int, arg("N")] = 9000
    """Seed of the first episode's initial conditions; each later episode has the next seed."""
    task: Annotated[str | None, arg("NAME|FILE")] = None
    """Task to judge it on: its scenario, what each start draws, and its most push cycles. If not given, that of the
    card of a policy folder, and for other policies the scenario alone."""
    scenario: Annotated[str | None, arg("NAME|FILE")] = None
    """Scenario with the robot ready to push, and the goal with its tolerances; that of the task if not given, push
    without a task."""
    changes: Changes = ()
    """Change a field of the scenario, such as room.slope_deg=3; may be given several times."""
    sweep: Annotated[Repeated[str], arg("FIELD=VALUE,...")] = ()
    """A field of the scenario and its values, such as box.mass_kg=0.1,0.5,0.9, box.size_m=0.4x0.5x0.4,0.8x0.4x0.4,
    box.shape=cuboid,l_shape or room.slope_deg=0,5. Give it again for other fields."""
    grid: Flag = False
    """Evaluate every combination of the swept values instead of one field after the other."""
    out: Annotated[Path | None, arg("DIR")] = None
    """Folder for episodes.csv, episodes.parquet, summary.json and evaluation.png; `runs/<time>-evaluate-<policy>` if
    not given."""
    dry_run: Flag = False
    """Check the options, print the scenario of each case, and start nothing."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Amount, self.episodes, "--episodes")
        require_seeds(self.seed, self.episodes, "--seed")
        if self.grid and not self.sweep:
            raise ConfigError("Expected --sweep with --grid, which combines the values of several")


@dataclass(frozen=True, kw_only=True)
class CalibrateOptions(SimulatorOptions):
    """Measure how pushes move a box: its travel and turn by face, leg, curve and depth, and the circle it turns on.

    `legpush run --push-map FILE` plans and follows paths with this map. Exit codes: 0 measured, 1 the robot fell, 2 bad
    input, 3 a simulator failed, 130 interrupted.
    """

    scenario: Positional[ScenarioName] = "default"
    """Scenario whose box is measured, on an open floor."""
    changes: Changes = ()
    """Change a field of the scenario, such as box.mass_kg=0.9; may be given several times."""
    depths_m: Annotated[tuple[float, ...], arg("M ...")] = SERIES_DEPTHS_M
    """Depths of the pushes."""
    curves: Annotated[tuple[float, ...], arg("W ...")] = SERIES_CURVES
    """Shapes of the curve: w1 = w2. Missions use the first one."""
    random_pushes: Annotated[int | None, arg("N")] = None
    """Measure N or more random pushes at each face instead of series of equal ones, with random leg, curve and depth,
    and fit a map for --world to them."""
    series: Annotated[int, arg("N")] = N_SERIES
    """Number of series of eight pushes, four with each leg, for every face, curve and depth."""
    seed: Annotated[int, arg("N")] = 8000
    """Seed of the place of the box in the first series; each later series has the next seed."""
    out: Annotated[Path, arg("FILE")] = Path("push_map.json")
    """The new file."""
    dry_run: Flag = False
    """Check the options, print the scenario with all changes, and start nothing."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Amount, self.series, "--series")
        require(Amount, self.random_pushes, "--random-pushes")
        require_seeds(self.seed, max(self.series, self.random_pushes or 0), "--seed")
        usual = (self.depths_m, self.curves, self.series) == (SERIES_DEPTHS_M, SERIES_CURVES, N_SERIES)
        if self.random_pushes is not None and not usual:
            raise ConfigError("Expected either --random-pushes or --depths-m, --curves and --series, got both")
        if not self.depths_m or not all(0.0 < depth_m <= MAX_DEPTH_M for depth_m in self.depths_m):
            raise ConfigError(
                f"Expected depths above 0 and at most {MAX_DEPTH_M} m for --depths-m, got {self.depths_m}"
            )
        if not any(depth_m >= USUAL_DEPTH_M for depth_m in self.depths_m):
            raise ConfigError(f"Expected a depth of {USUAL_DEPTH_M} m or more in --depths-m, got {self.depths_m}")
        for flag, values in (("--depths-m", self.depths_m), ("--curves", self.curves)):
            if len(set(values)) < len(values):
                raise ConfigError(f"Expected each value once for {flag}, got {values}")
        if not self.curves or not all(0.0 <= w <= 1.0 for w in self.curves):
            raise ConfigError(f"Expected values in [0, 1] for --curves, got {self.curves}")
