"""What a policy of a task observes: the table of its profile, its space, and its vector."""

from typing import Final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from agent_proc.frames.push_view import PushView
from agent_proc.task.config import TaskConfig
from agent_proc.task.observation_paper import PAPER
from agent_proc.task.observation_relative import RELATIVE
from agent_proc.task.observation_table import Table, bounds, read_table

TABLES: Final[dict[str, Table]] = {"paper": PAPER, "relative": RELATIVE}


def observation_space(task: TaskConfig) -> spaces.Box:
    """The space of the observation: bounds of each element, (n,)."""
    low, high = bounds(TABLES[task.observation], task.scenario)
    return spaces.Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def observe(task: TaskConfig, view: PushView) -> NDArray[np.float32]:
    """The observation vector, (n,)."""
    return read_table(TABLES[task.observation], view).astype(np.float32)
