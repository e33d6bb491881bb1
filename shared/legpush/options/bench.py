"""Options of `legpush bench`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Switch, arg
from legpush.errors import ConfigError
from legpush.fields import Seed, require

MAX_STEPS = 1_000_000_000


@dataclass(frozen=True, kw_only=True)
class SoakOptions:
    """Disturb whole missions, one fault at a time, and check that each ends as if nothing had happened.

    Results go to DIR/soak.json after each cell. Ctrl-C keeps them; the same command goes on. Exit codes: 0 everything
    is as expected, 1 something is not, 2 bad input, 3 an undisturbed mission failed, 130 interrupted.
    """

    out: Annotated[Path, arg("DIR")] = Path("runs/soak")
    """Folder of the results; also keeps the missions that did not end as expected."""
    cells: Annotated[tuple[str, ...], arg("CELL ...")] = ()
    """The cells of the table to run, such as kill-sim-walking, or all of a kind, such as kill; all if not given."""
    table: Switch = True
    """Run the table of faults."""
    seed: Annotated[int, arg("N")] = 0
    """Seed of the mission and of the faults."""
    repeat: Annotated[int, arg("N")] = 1
    """How often to run each cell, with the seeds from --seed on."""
    retry: Flag = False
    """Run the cells again that were not as expected."""
    steps: Annotated[int | None, arg("N")] = None
    """Besides, do this many lockstep steps with a stub simulator, and watch memory, threads and open files."""
    training: Annotated[float | None, arg("HOURS")] = None
    """Besides, train for about this long while a simulator is killed every 30 s and the learner ten times, and compare
    the policy with that of an undisturbed training, which runs beside it."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(Seed, self.seed, "--seed")
        if not 1 <= self.repeat <= MAX_STEPS:
            raise ConfigError(f"Expected 1 to {MAX_STEPS} for --repeat, got {self.repeat}")
        if self.steps is not None and not 1 <= self.steps <= MAX_STEPS:
            raise ConfigError(f"Expected 1 to {MAX_STEPS} for --steps, got {self.steps}")
        if self.training is not None and not 0.0 < self.training <= 1000.0:
            raise ConfigError(f"Expected more than 0 and at most 1000 hours for --training, got {self.training}")
        if not self.table and (self.cells or (self.steps is None and self.training is None)):
            raise ConfigError("Expected --steps or --training with --no-table, and no --cells: nothing else is done")


@dataclass(frozen=True, kw_only=True)
class ListFaults:
    """List the cells of the table of faults, with what is expected of each."""

    output: OutputOptions = USUAL_OUTPUT
