"""A push that the simulator refuses ends an episode of the environment, and nothing else."""

import numpy as np

from agent_proc.learning.env import PushEnv
from legpush.errors import MotionError
from legpush.messages.stepping import Motion, Push
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.tasks import tuned


def test_a_push_that_the_legs_cannot_follow_terminates_and_another_episode_begins() -> None:
    def refused(motion: Motion, n: int) -> bool:
        if isinstance(motion, Push) and n == 2:
            raise MotionError("Expected the curve of a push that the leg follows")
        return False

    env = PushEnv(tuned(scenario=scenario_at_station()), FakeWorld(falls_in=refused))
    action = np.zeros(4, dtype=np.float32)
    env.reset(seed=0)
    _, _, terminated, _, _ = env.step(action)
    assert not terminated
    _, _, terminated, truncated, info = env.step(action)

    assert (terminated, truncated, info["ending"], info["is_success"]) == (True, False, "refused", False)
    env.reset()
    assert not env.step(action)[2]
