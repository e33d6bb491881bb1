"""The observation of a pushing policy (Eq. 18): one table, from which vector, bounds and documentation come.

The tracked corners are the front left and the front right one of the box, at its upper edge: the side that leads.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from agent_proc.corners import goal_corners_m, tracked_corners_m
from legpush.messages import WorldState
from legpush.robot import LEGS
from legpush.scenario import Scenario

Floats = NDArray[np.float64]

BEYOND_M: Final = 1.0
"""How far the bounds reach beyond the room, and above the box."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """Consecutive elements of the observation."""

    name: str
    axes: Literal["xyz", "xy"]
    read: Callable[[WorldState, Scenario], Floats]
    """The values, with the length of `axes`."""
    meaning: str
    unit: str = "m"
    frame: str = "world"

    @property
    def size(self) -> int:
        """Number of elements."""
        return len(self.axes)


def _corner(index: int) -> Callable[[WorldState, Scenario], Floats]:
    return lambda world, scenario: tracked_corners_m(world.box, scenario.box)[index]


def _goal_corner(index: int) -> Callable[[WorldState, Scenario], Floats]:
    return lambda _, scenario: goal_corners_m(scenario)[index]


def _tip(index: int) -> Callable[[WorldState, Scenario], Floats]:
    return lambda world, _: np.array(world.tips_m[index])


PAPER: Final[tuple[Entry, ...]] = (
    Entry(name="body", axes="xyz", read=lambda world, _: np.array(world.trunk.position_m), meaning="trunk centre"),
    Entry(name="box_corner_1", axes="xyz", read=_corner(0), meaning="front left upper corner of the box"),
    Entry(name="box_corner_2", axes="xyz", read=_corner(1), meaning="front right upper corner of the box"),
    *(
        Entry(name=f"tip_{leg}", axes="xyz", read=_tip(index), meaning=f"centre of the foot sphere of {leg}")
        for index, leg in enumerate(LEGS)
    ),
    Entry(name="goal_corner_1", axes="xy", read=_goal_corner(0), meaning="where corner 1 has to be"),
    Entry(name="goal_corner_2", axes="xy", read=_goal_corner(1), meaning="where corner 2 has to be"),
)
"""The profile `paper`: 25 elements, all of them positions in the world frame."""


def observe(world: WorldState, scenario: Scenario, table: tuple[Entry, ...] = PAPER) -> Floats:
    """The observation vector, (n,): the entries of the table one after the other."""
    return np.concatenate([entry.read(world, scenario) for entry in table])


def bounds(scenario: Scenario, table: tuple[Entry, ...] = PAPER) -> tuple[Floats, Floats]:
    """Lowest and highest values, (n,) each: the room up to the height of the box, and `BEYOND_M` on every side."""
    size_m = np.array([*scenario.room.size_m, scenario.box.size_m[2]])
    high = np.concatenate([size_m[: entry.size] for entry in table]) + BEYOND_M
    return np.full(len(high), -BEYOND_M), high


def as_markdown(table: tuple[Entry, ...] = PAPER) -> str:
    """The table for the documentation."""
    lines = ["| elements | name | axes | unit | frame | meaning |", "| --- | --- | --- | --- | --- | --- |"]
    first = 0
    for entry in table:
        last = first + entry.size - 1
        lines.append(
            f"| {first} to {last} | `{entry.name}` | {entry.axes} | {entry.unit} | {entry.frame} | {entry.meaning} |"
        )
        first = last + 1
    beyond = f"Bounds: x and y from -{BEYOND_M:g} m to the room's size + {BEYOND_M:g} m, z to the box's height + "
    return "\n".join([*lines, "", f"{beyond}{BEYOND_M:g} m.", ""])
