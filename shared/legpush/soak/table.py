"""The table of faults: each kind of fault, for each role, in each phase, and what must come of it."""

import csv
from dataclasses import dataclass
from importlib.resources import files
from typing import Final, Literal, get_args

from legpush.errors import ConfigError

TABLE_FILE: Final = "faults.csv"

Kind = Literal[
    "kill",
    "terminate",
    "freeze_short",
    "freeze_long",
    "cut",
    "stall",
    "delay",
    "slow_consumer",
    "corrupt",
    "drop",
    "duplicate",
    "reorder",
    "disk_full",
    "clock_back",
    "clock_ahead",
]
"""`docs/robustness.md` says what each does."""
FaultRole = Literal["planner", "sim", "agent"]
Phase = Literal["planning", "walking", "pushing"]
Expected = Literal["same", "goes_on", "none"]
"""`same`: the mission ends as the undisturbed one, with the same `state_crc`. `goes_on`: it ends with exit code 5 and
one error, and the same command then ends as the undisturbed one. `none`: the cell makes no sense."""

KINDS: Final[tuple[Kind, ...]] = get_args(Kind)
ROLES: Final[tuple[FaultRole, ...]] = get_args(FaultRole)
PHASES: Final[tuple[Phase, ...]] = get_args(Phase)


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One fault, and what must come of it."""

    kind: Kind
    role: FaultRole
    phase: Phase
    expected: Expected
    why: str = ""
    """Why the cell makes no sense, if so."""

    @property
    def name(self) -> str:
        """Name of the cell on the command line, such as `kill-sim-walking`."""
        return f"{self.kind}-{self.role}-{self.phase}"


def read_table() -> tuple[Cell, ...]:
    """Return all cells, also those that make no sense."""
    text = files("legpush.soak").joinpath(TABLE_FILE).read_text(encoding="utf-8")
    return tuple(Cell(**row) for row in csv.DictReader(text.splitlines()))  # type: ignore[arg-type]


def choose_cells(names: tuple[str, ...]) -> tuple[Cell, ...]:
    """Return the cells with these names, or all that make sense if there are no names; a kind stands for its cells.

    Raises:
        ConfigError: There is no such cell or kind.
    """
    table = tuple(cell for cell in read_table() if cell.expected != "none")
    chosen: list[Cell] = []
    for name in names:
        found = [cell for cell in table if name in (cell.name, cell.kind)]
        if not found:
            raise ConfigError(
                f"Expected a cell such as {table[0].name}, or a kind of fault ({', '.join(KINDS)}), got {name!r}"
            )
        chosen += found
    return tuple(dict.fromkeys(chosen)) if names else table
