"""States of learners: a restored learner goes on as before, and a state that does not fit is refused."""

from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.learning.learner import make_learner
from agent_proc.learning.learner_state import LearnerState, ReplayState, capture, restore
from agent_proc.learning.plain_array import to_plain
from agent_proc.learning.vec_env import PushVecEnv
from legpush.errors import ConfigError
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.learning.small_training import learned, small_profile, weights
from tests.agent.tasks import tuned

TASK = tuned(scenario=scenario_at_station(), max_steps=5)
WRONG = to_plain(np.zeros(3))


@pytest.fixture
def env() -> Iterator[PushVecEnv]:
    """Two environments without physics."""
    env = PushVecEnv(TASK, [FakeWorld(), FakeWorld()])
    yield env
    env.close()


@pytest.fixture
def other_env() -> Iterator[PushVecEnv]:
    """The same again."""
    env = PushVecEnv(TASK, [FakeWorld(), FakeWorld()])
    yield env
    env.close()


def saved(state: LearnerState) -> LearnerState:
    """The state, written to a file and read from it."""
    return msgspec.msgpack.decode(msgspec.msgpack.encode(state), type=LearnerState)


@pytest.mark.parametrize("name", ["tuned", "paper-text", "sac", "td3"])
def test_a_restored_learner_goes_on_to_the_same_weights_and_the_same_state(
    env: PushVecEnv, other_env: PushVecEnv, name: str
) -> None:
    profile = small_profile(name)
    learner = learned(profile, env, 64)
    captured = capture(learner)
    expected = learned(profile, env, 64, learner)
    state = capture(expected)

    other = make_learner(profile, other_env, 99)
    restore(other, saved(captured))

    assert other.model.num_timesteps == 64
    assert capture(other) == captured
    assert weights(learned(profile, other_env, 64, other).model) == weights(expected.model)
    assert without_times(capture(other)) == without_times(state)


def without_times(state: LearnerState) -> LearnerState:
    """The state without the wall-clock times of its episodes."""
    return replace(state, episode_times_s=())


def replay(state: LearnerState) -> ReplayState:
    assert state.replay is not None
    return state.replay


CHANGES: dict[str, Callable[[LearnerState], dict[str, Any]]] = {
    "weights": lambda state: {"weights": {}},
    r"weights\.": lambda state: {"weights": dict.fromkeys(state.weights, WRONG)},
    "counters": lambda state: {"counters": {}},
    "temperature": lambda state: {"temperature": None},
    "optimizers": lambda state: {"optimizers": {}},
    r"optimizers\.actor": lambda state: {
        "optimizers": {name: replace(one, parameters=()) for name, one in state.optimizers.items()}
    },
    "replay`: expected the steps": lambda state: {"replay": None},
    r"replay\.position": lambda state: {"replay": replace(replay(state), position=10**9)},
    r"replay\.": lambda state: {"replay": replace(replay(state), arrays=dict.fromkeys(replay(state).arrays, WRONG))},
    "replay`: expected `": lambda state: {"replay": replace(replay(state), arrays={})},
    r"last\.": lambda state: {"last": dict.fromkeys(state.last, WRONG)},
    "moments`": lambda state: {"moments": {}},
    "discounted_returns": lambda state: {"discounted_returns": WRONG},
    "seen": lambda state: {"seen": WRONG},
    "rewards": lambda state: {"rewards": WRONG},
    "running_returns": lambda state: {"running_returns": WRONG},
    "episode_returns": lambda state: {"episode_returns": WRONG},
    r"random\.torch": lambda state: {"random": replace(state.random, torch=WRONG)},
    r"random\.numpy": lambda state: {"random": replace(state.random, numpy=WRONG)},
}


@pytest.mark.parametrize("place", CHANGES)
def test_a_state_that_does_not_fit_is_refused_with_the_place(env: PushVecEnv, place: str) -> None:
    profile = small_profile("sac")
    state = capture(learned(profile, env, 40))

    with pytest.raises(ValueError, match=f"at `{place}"):
        restore(make_learner(profile, env, 3), replace(state, **CHANGES[place](state)))


def test_the_state_of_another_algorithm_is_refused(env: PushVecEnv) -> None:
    state = capture(learned(small_profile("td3"), env, 40))

    with pytest.raises(ValueError, match="at `weights`: expected "):
        restore(make_learner(small_profile("sac"), env, 3), state)


def test_another_number_of_environments_is_refused(env: PushVecEnv) -> None:
    state = capture(learned(small_profile(), env, 40))
    one = PushVecEnv(TASK, [FakeWorld()])

    with pytest.raises(ConfigError, match="Expected as many simulators as were saved, 2, got 1"):
        restore(make_learner(small_profile(), one, 3), state)
    one.close()
