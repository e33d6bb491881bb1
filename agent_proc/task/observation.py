"""The observation of a pushing policy as a table, from which vector, bounds and documentation come.

The profile `paper` is Eq. 18; its tracked corners are the front left and the front right one of the box, at its upper
edge: the side that leads.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from agent_proc.frames.corners import goal_corners_m, tracked_corners_m
from legpush.arrays import Floats
from legpush.messages.stepping import WorldState
from legpush.scene.robot import LEGS
from legpush.scene.scenario import Scenario

BEYOND_M: Final = 1.0
"""How far the bounds reach beyond the room, and above the box."""


def _room_bounds(scenario: Scenario) -> tuple[Floats, Floats]:
    """Lowest and highest x, y and z: the room up to the height of the box, and `BEYOND_M` on every side."""
    high = np.array([*scenario.room.size_m, scenario.box.size_m[2]]) + BEYOND_M
    return np.full(3, -BEYOND_M), high


@dataclass(frozen=True, kw_only=True)
class Entry:
    """Consecutive elements of the observation."""

    name: str
    axes: str
    """What people call the elements."""
    size: int
    """Number of elements."""
    read: Callable[[WorldState, Scenario], Floats]
    """The values, (size,)."""
    meaning: str
    unit: str = "m"
    frame: str = "world"
    limits: Callable[[Scenario], tuple[Floats, Floats]] = _room_bounds
    """Lowest and highest values, at least (size,) each."""


Table = tuple[Entry, ...]


def _corner(index: int) -> Callable[[WorldState, Scenario], Floats]:
    return lambda world, scenario: tracked_corners_m(world.box, scenario.box)[index]


def _goal_corner(index: int) -> Callable[[WorldState, Scenario], Floats]:
    return lambda _, scenario: goal_corners_m(scenario)[index]


def _tip(index: int) -> Callable[[WorldState, Scenario], Floats]:
    return lambda world, _: np.array(world.tips_m[index])


def _place(name: str, read: Callable[[WorldState, Scenario], Floats], meaning: str, axes: str = "xyz") -> Entry:
    return Entry(name=name, axes=axes, size=len(axes), read=read, meaning=meaning)


PAPER: Final[Table] = (
    _place("body", lambda world, _: np.array(world.trunk.position_m), "trunk centre"),
    _place("box_corner_1", _corner(0), "front left upper corner of the box"),
    _place("box_corner_2", _corner(1), "front right upper corner of the box"),
    *(_place(f"tip_{leg}", _tip(index), f"centre of the foot sphere of {leg}") for index, leg in enumerate(LEGS)),
    _place("goal_corner_1", _goal_corner(0), "where corner 1 has to be", "xy"),
    _place("goal_corner_2", _goal_corner(1), "where corner 2 has to be", "xy"),
)
"""The profile `paper`: 25 elements, all of them positions in the world frame."""


def observe(world: WorldState, scenario: Scenario, table: Table = PAPER) -> Floats:
    """The observation vector, (n,): the entries of the table one after the other."""
    return np.concatenate([entry.read(world, scenario) for entry in table])


def bounds(scenario: Scenario, table: Table = PAPER) -> tuple[Floats, Floats]:
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


def as_markdown(table: Table = PAPER) -> str:
    """The table for the documentation."""
    lines = ["| elements | name | axes | unit | frame | meaning |", "| --- | --- | --- | --- | --- | --- |"]
    first = 0
    for entry in table:
        last = first + entry.size - 1
        elements = f"{first} to {last}" if last > first else f"{first}"
        lines.append(f"| {elements} | `{entry.name}` | {entry.axes} | {entry.unit} | {entry.frame} | {entry.meaning} |")
        first = last + 1
    return "\n".join([*lines, ""])
