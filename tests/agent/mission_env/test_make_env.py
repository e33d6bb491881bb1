"""Making the environment of missions from plain data."""

from typing import Any

import pytest
from msgspec import UNSET

from agent_proc.mission_env.make_env import make_mission_env
from agent_proc.task.file import load_task
from legpush.errors import ConfigError, PluginError
from legpush.scenarios.file import load_scenario
from tests.agent.fake_world import FakeWorld


def test_without_arguments_it_is_level_4() -> None:
    assert make_mission_env(world=FakeWorld()).task == load_task("push-l4")


def test_settings_are_fields_of_the_task() -> None:
    task = make_mission_env(world=FakeWorld(), random_room={"obstacles": 3}, mass_kg=[0.5, 1.0], max_steps=9).task

    assert task.random_room is not UNSET
    assert (task.random_room.obstacles, task.domain.mass_kg, task.max_steps) == (3, (0.5, 1.0), 9)


def test_a_scenario_takes_the_place_of_the_rooms() -> None:
    task = make_mission_env(world=FakeWorld(), scenario="push").task

    assert (task.scenario, task.random_room) == (load_scenario("push"), UNSET)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"random_room": {"obstacle": 3}}, ConfigError, "at `random_room.obstacle`"),
        ({"random_room": {"obstacles": -1}}, ConfigError, "Expected 0 to 1000 obstacles, got -1"),
        ({"distance_m": [0.1, 1.0]}, ConfigError, "mass_kg and friction alone in the domain .*, got distance_m"),
        ({"changes_face": True}, ConfigError, "Expected no `changes_face` with `random_room`"),
        ({"task": "push-l1"}, ConfigError, "changes_face = false"),
        ({"world": None, "planner": "stars"}, PluginError, "stars"),
        ({"colour": "red"}, ConfigError, "Expected settings among .*, got colour"),
    ],
)
def test_an_argument_that_cannot_be_used_is_refused(
    arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        make_mission_env(**{"world": FakeWorld(), **arguments})


def test_two_environments_do_not_share_a_simulator() -> None:
    world = FakeWorld()
    env = make_mission_env(world=world)
    with pytest.raises(ConfigError, match="a simulator of its own for each MissionEnv"):
        make_mission_env(world=world)
    env.close()
    assert make_mission_env(world=world).task == env.task
