"""Options of the tools around training: `legpush compare`."""

import os
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated, Final, Literal

import tyro

from legpush.bounds import Amount
from legpush.errors import ConfigError
from legpush.fields import require, require_seeds
from legpush.options.learning import DEFAULT_WORLD

FIRST_HELD_OUT_SEED: Final = 5_000_000
"""First of the starts on which policies are compared: nothing else uses them."""


def usual_workers() -> int:
    """Return the default number of worker processes: one per core that this process may use."""
    return len(os.sched_getaffinity(0))


def dated(command: str) -> Path:
    """Return the default folder of a command that begins now."""
    return Path("runs") / f"{datetime.now().astimezone():%Y%m%d-%H%M%S}-{command}"


@dataclass(frozen=True, kw_only=True)
class CompareOptions:
    """Compare trainings and policies on equal held-out starts, beside the dumbest rivals: zero, random, best constant.

    A RUN is the folder of trainings with several seeds or of a single training, a policy folder, or the name of a
    policy. Each number has its 95 % interval over trainings and starts; differences are paired. It is a study: the same
    command with the same --out goes on after an interruption. Exit codes: 0 compared, 2 bad input, 3 a cell failed,
    130 interrupted.
    """

    runs: Annotated[tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="RUN ...")]
    """Trainings or policies."""
    policy: Literal["best", "last"] = "best"
    """Which policy of each training."""
    against: Annotated[str, tyro.conf.arg(metavar="NAME")] = "constant"
    """Whom to compare the others with: a rival, or the name of a RUN as the table shows it."""
    episodes: Annotated[int, tyro.conf.arg(metavar="N")] = 50
    """Number of starts, for each swept value."""
    first_seed: Annotated[int, tyro.conf.arg(metavar="N")] = FIRST_HELD_OUT_SEED
    """Seed of the first start."""
    scenario: Annotated[str, tyro.conf.arg(metavar="NAME|FILE")] = "push"
    """Scenario with the robot ready to push, and the goal with its tolerances."""
    sweep: Annotated[tyro.conf.UseAppendAction[tuple[str, ...]], tyro.conf.arg(metavar="FIELD=VALUE,...")] = ()
    """A field of the scenario and its values, such as box.mass_kg=0.1,0.5,0.9; given again, all combinations."""
    world: Annotated[str, tyro.conf.arg(metavar="NAME")] = DEFAULT_WORLD
    """What is pushed in: `mujoco`, the simulator; `map`, a map of the default box without physics; another plug-in."""
    search_world: Annotated[str, tyro.conf.arg(metavar="NAME")] = "map"
    """What the best constant is searched in, on starts of its own: 426 episodes with variable entry. `map` knows the
    default box alone."""
    workers: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Number of worker processes; if not given, one per core."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """Folder for comparison.json, comparison.csv, comparison.png and the studies; `runs/<time>-compare` if not
    given."""
    json: bool = False
    """Print the numbers as JSON instead of tables; what is under way goes to standard error."""

    def __post_init__(self) -> None:
        if not self.runs:
            raise ConfigError("Expected at least one RUN: a training, a policy folder, or the name of a policy")
        require(Amount, self.episodes, "--episodes")
        require(Amount, self.workers, "--workers")
        require_seeds(self.first_seed, self.episodes, "--first-seed")

    @property
    def n_workers(self) -> int:
        """Number of worker processes."""
        return self.workers if self.workers is not None else usual_workers()
