"""An observation as a table of entries, from which vector, bounds and documentation come."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from agent_proc.frames.push_view import PushView
from legpush.arrays import Floats
from legpush.scene.scenario import Scenario

BEYOND_M: Final = 1.0
"""How far the bounds reach beyond the room, and above the box."""


def room_limits(scenario: Scenario) -> tuple[Floats, Floats]:
    """Lowest and highest x, y and z: the room up to the height of the box, and `BEYOND_M` on every side."""
    high = np.array([*scenario.room.size_m, scenario.box.size_m[2]]) + BEYOND_M
    return np.full(3, -BEYOND_M), high


@dataclass(frozen=True, kw_only=True)
class Entry:
    """Consecutive elements of the observation."""

    name: str
    axes: str
    """Names of the elements for the documentation."""
    size: int
    """Number of elements."""
    read: Callable[[PushView], Floats]
    """The values, (size,)."""
    meaning: str
    unit: str = "m"
    frame: str = "world"
    limits: Callable[[Scenario], tuple[Floats, Floats]] = room_limits
    """Lowest and highest values, at least (size,) each."""


Table = tuple[Entry, ...]


def read_table(table: Table, view: PushView) -> Floats:
    """The observation vector, (n,): the entries of the table one after the other."""
    return np.concatenate([entry.read(view) for entry in table])


def bounds(table: Table, scenario: Scenario) -> tuple[Floats, Floats]:
    """Lowest and highest values, (n,) each."""
    low, high = zip(*(entry.limits(scenario) for entry in table), strict=True)
    sizes = [entry.size for entry in table]
    return (
        np.concatenate([values[:size] for values, size in zip(low, sizes, strict=True)]),
        np.concatenate([values[:size] for values, size in zip(high, sizes, strict=True)]),
    )


def element_names(table: Table) -> tuple[str, ...]:
    """A name for each element."""
    return tuple(f"{entry.name}[{index}]" for entry in table for index in range(entry.size))


def as_markdown(table: Table) -> str:
    """The table in Markdown for the documentation."""
    lines = ["| elements | name | axes | unit | frame | meaning |", "| --- | --- | --- | --- | --- | --- |"]
    first = 0
    for entry in table:
        last = first + entry.size - 1
        elements = f"{first} to {last}" if last > first else f"{first}"
        lines.append(f"| {elements} | `{entry.name}` | {entry.axes} | {entry.unit} | {entry.frame} | {entry.meaning} |")
        first = last + 1
    return "\n".join([*lines, ""])
