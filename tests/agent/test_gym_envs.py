"""The former address of the environment."""

import gymnasium

from agent_proc.learning.env import PushEnv
from tests.agent.fake_world import FakeWorld


def test_the_environment_is_made_by_its_former_address() -> None:
    env = gymnasium.make("agent_proc.gym_envs:legpush/Push-v1", world=FakeWorld())

    assert isinstance(env.unwrapped, PushEnv)
