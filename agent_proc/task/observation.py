"""What a policy of a task observes: the table of its profile, its bounds, and its vector."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from agent_proc.frames.push_view import PushView
from agent_proc.task.config import TaskConfig
from agent_proc.task.observation_paper import PAPER
from agent_proc.task.observation_relative import RELATIVE
from agent_proc.task.observation_table import Table, bounds, read_table

TABLES: Final[dict[str, Table]] = {"paper": PAPER, "relative": RELATIVE}


def n_observed(task: TaskConfig) -> int:
    """Number of elements of the observation."""
    return sum(entry.size for entry in TABLES[task.observation])


def observation_bounds(task: TaskConfig) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Lowest and highest values of the observation, (n,) each."""
    low, high = bounds(TABLES[task.observation], task.scenario)
    return low.astype(np.float32), high.astype(np.float32)


def observe(task: TaskConfig, view: PushView) -> NDArray[np.float32]:
    """The observation vector, (n,)."""
    return read_table(TABLES[task.observation], view).astype(np.float32)
