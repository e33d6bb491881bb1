"""What a policy is given and what its answer means: spaces, end, observation and push."""

from typing import Any, Final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from agent_proc.frames.poses import box_error
from agent_proc.task.action import no_push_helps, to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.observation import PAPER, Table, bounds, observe
from agent_proc.task.observation_relative import RELATIVE
from legpush.messages.stepping import Push, WorldState
from legpush.scene.scenario import Scenario

TABLES: Final[dict[str, Table]] = {"paper": PAPER, "relative": RELATIVE}


def observation_space(task: TaskConfig) -> spaces.Box:
    """What the environment shows: bounds of each element, (n,)."""
    low, high = bounds(task.scenario, TABLES[task.observation])
    return spaces.Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def is_done(task: TaskConfig, world: WorldState, scenario: Scenario) -> bool:
    """Whether a policy that learned this task has nothing left to do here, be it good or bad."""
    if task.reward == "paper":
        return box_error(world, scenario).within(scenario.goal)
    return no_push_helps(task, world, scenario)


def policy_observation(task: TaskConfig, world: WorldState, scenario: Scenario) -> NDArray[np.float32]:
    """What the environment shows a policy of this task in this state, (n,)."""
    return observe(world, scenario, TABLES[task.observation]).astype(np.float32)


def policy_push(task: TaskConfig, action: NDArray[Any], world: WorldState, scenario: Scenario) -> Push:
    """What the environment makes of the action of a policy of this task."""
    return to_push(action, task, world, scenario)
