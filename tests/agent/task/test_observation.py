"""What a policy of a task observes."""

from dataclasses import replace

import numpy as np
import pytest

from agent_proc.frames.push_view import push_view
from agent_proc.task.config import TaskConfig
from agent_proc.task.observation import TABLES, n_observed, observation_bounds, observe
from agent_proc.task.observation_table import read_table
from legpush.geometry import Pose2
from legpush.scene.scenario import Room
from tests.agent.fake_world import make_scenario, make_state, scenario_at_station

RELATIVE = TaskConfig(scenario=scenario_at_station())
PAPER = TaskConfig(observation="paper", scenario=scenario_at_station())
VIEW = push_view(
    make_state(Pose2(x_m=5.3, y_m=3.0, yaw_rad=0.1), Pose2(x_m=6.0, y_m=2.9, yaw_rad=0.1)), RELATIVE.scenario
)


@pytest.mark.parametrize(("task", "n_elements"), [(RELATIVE, 8), (PAPER, 25)], ids=["relative", "paper"])
def test_the_observation_is_within_its_bounds(task: TaskConfig, n_elements: int) -> None:
    observation = observe(task, VIEW)

    low, high = observation_bounds(task)
    assert observation.shape == low.shape == high.shape == (n_elements,)
    assert n_observed(task) == n_elements
    assert observation.dtype == low.dtype == high.dtype == np.float32
    assert ((low <= observation) & (observation <= high)).all()


@pytest.mark.parametrize("task", [RELATIVE, PAPER], ids=["relative", "paper"])
def test_the_observation_reads_the_table_of_its_profile(task: TaskConfig) -> None:
    expected = read_table(TABLES[task.observation], VIEW)

    np.testing.assert_array_equal(observe(task, VIEW), expected.astype(np.float32))


def test_two_observations_of_one_view_share_no_memory() -> None:
    assert not np.shares_memory(observe(PAPER, VIEW), observe(PAPER, VIEW))


def test_the_bounds_follow_the_room_of_the_task() -> None:
    larger = replace(PAPER, scenario=make_scenario(room=Room(size_m=(30.0, 6.0))))

    assert observation_bounds(larger)[1][0] == observation_bounds(PAPER)[1][0] + 18.0
