"""The profile `paper`: the observation of Eq. 18.

Its tracked corners are the front left and the front right one of the box, at its upper edge: the side that leads.
"""

from collections.abc import Callable
from typing import Final

import numpy as np

from agent_proc.frames.push_view import PushView
from agent_proc.task.observation_table import Entry, Table
from legpush.arrays import Floats
from legpush.scene.conventions import LEGS


def _corner(index: int) -> Callable[[PushView], Floats]:
    return lambda view: view.corners_w_m[index]


def _goal_corner(index: int) -> Callable[[PushView], Floats]:
    return lambda view: view.goal_corners_w_m[index]


def _tip(index: int) -> Callable[[PushView], Floats]:
    return lambda view: np.array(view.world.tips_m[index])


def _place(name: str, read: Callable[[PushView], Floats], meaning: str, axes: str = "xyz") -> Entry:
    return Entry(name=name, axes=axes, size=len(axes), read=read, meaning=meaning)


PAPER: Final[Table] = (
    _place("body", lambda view: np.array(view.world.trunk.position_m), "trunk centre"),
    _place("box_corner_1", _corner(0), "front left upper corner of the box"),
    _place("box_corner_2", _corner(1), "front right upper corner of the box"),
    *(_place(f"tip_{leg}", _tip(index), f"centre of the foot sphere of {leg}") for index, leg in enumerate(LEGS)),
    _place("goal_corner_1", _goal_corner(0), "where corner 1 has to be", "xy"),
    _place("goal_corner_2", _goal_corner(1), "where corner 2 has to be", "xy"),
)
"""25 elements, all of them positions in the world frame."""
