"""`max_episode_steps` is the length of an episode."""

from typing import Any, cast

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec

from agent_proc.learning.env import PushEnv
from agent_proc.mission_env.env import MissionEnv
from legpush.errors import ConfigError

PUSH = "legpush.gym:legpush/Push-v1"
MISSIONS = "legpush.gym:legpush/PushL4-v2"
NOTHING = np.zeros(4, dtype=np.float32)


def length(env: gymnasium.Env[Any, Any]) -> int:
    return cast(PushEnv | MissionEnv, env.unwrapped).task.max_steps


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, 200),
        ({"max_episode_steps": 300}, 300),
        ({"max_episode_steps": 300, "max_steps": 300}, 300),
        ({"max_episode_steps": 3}, 3),
        ({"max_episode_steps": -1}, 200),
        ({"max_episode_steps": -1, "max_steps": 500}, 500),
        ({"max_steps": 7}, 7),
        ({"task": "push-l1"}, 100),
        ({"task": "push-l1", "max_episode_steps": 300}, 300),
    ],
)
def test_an_episode_has_the_length_that_was_given(given: dict[str, Any], expected: int) -> None:
    env = gymnasium.make(PUSH, **given)
    assert length(env) == expected
    assert env.spec is not None
    again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))
    assert length(again) == expected


def test_missions_have_it_as_well() -> None:
    assert length(gymnasium.make(MISSIONS, max_episode_steps=500)) == 500


@pytest.mark.parametrize("n", [1, 2])
def test_the_last_step_says_how_the_episode_ended(n: int) -> None:
    env = gymnasium.make(PUSH, simulator="map", max_episode_steps=n)
    env.reset(seed=3)
    steps = [env.step(NOTHING) for _ in range(n)]
    assert [step[3] for step in steps] == [False] * (n - 1) + [True]
    assert [step[4].get("ending") for step in steps] == [None] * (n - 1) + ["max_steps"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"max_steps": 300}, "at most 200 push cycles .*Push-v1, got 300 for max_steps; give max_episode_steps=300"),
        ({"max_steps": 7, "max_episode_steps": 9}, "one length .*, got 7 for max_steps and 9 for max_episode_steps"),
        ({"max_episode_steps": 10_001}, "Expected 1 to 10000 for max_episode_steps, got 10001"),
    ],
)
def test_a_length_that_cannot_be_is_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        gymnasium.make(PUSH, **given)
