"""Observations and actions as learners know them."""

import numpy as np
import pytest
from gymnasium import spaces

from agent_proc.policies.sb3.spaces import action_space, observation_space
from agent_proc.task.config import TaskConfig
from agent_proc.task.observed import observation_bounds
from tests.agent.tasks import paper, tuned


def test_each_form_of_action_has_its_space() -> None:
    discrete = paper(entry="fixed", action_form="discrete")

    assert action_space(discrete) == spaces.MultiDiscrete([8, 8, 2])
    assert action_space(tuned(entry="fixed")) == spaces.Box(-1.0, 1.0, (3,), np.float32)
    assert action_space(tuned()) == spaces.Box(-1.0, 1.0, (4,), np.float32)


@pytest.mark.parametrize("task", [tuned(), paper()], ids=["relative", "paper"])
def test_the_space_of_observations_has_their_bounds(task: TaskConfig) -> None:
    space = observation_space(task)

    np.testing.assert_array_equal([space.low, space.high], observation_bounds(task))
