"""Observations and actions of a task as spaces of Gymnasium, for learners."""

from typing import Any

import numpy as np
from gymnasium import spaces

from agent_proc.task.action import CHOICES, n_actions
from agent_proc.task.config import TaskConfig
from agent_proc.task.observed import observation_bounds


def observation_space(task: TaskConfig) -> spaces.Box:
    """The space of the observation: bounds of each element, (n,)."""
    low, high = observation_bounds(task)
    return spaces.Box(low, high, dtype=np.float32)


def action_space(task: TaskConfig) -> spaces.Space[Any]:
    """The space of actions: `MultiDiscrete([8, 8, 2])`, or w1, w2, leg (and depth) in [-1, 1]."""
    if task.action_form == "discrete":
        return spaces.MultiDiscrete(list(CHOICES))
    return spaces.Box(-1.0, 1.0, (n_actions(task),), np.float32)
