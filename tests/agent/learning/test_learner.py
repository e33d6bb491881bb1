"""Learners: built as a profile says, and policies are taken out of them."""

from collections.abc import Iterator

import msgspec
import numpy as np
import pytest
import torch
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm

from agent_proc.learning.learner import (
    DEPTH,
    make_learner,
    observation_moments,
    set_exploration,
    undisturbed_draws,
)
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.profiles.profile import PpoProfile
from legpush.errors import ConfigError
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.learning.small_training import learned, small_profile, weights
from tests.agent.tasks import tuned

TASK = tuned(scenario=scenario_at_station(), max_steps=5)


@pytest.fixture
def env() -> Iterator[PushVecEnv]:
    """Two environments without physics."""
    env = PushVecEnv(TASK, [FakeWorld(), FakeWorld()])
    yield env
    env.close()


@pytest.mark.parametrize(("name", "kind"), [("tuned", PPO), ("paper-text", PPO), ("sac", SAC), ("td3", TD3)])
def test_a_profile_names_its_algorithm(env: PushVecEnv, name: str, kind: type[BaseAlgorithm]) -> None:
    learner = make_learner(small_profile(name), env, 3)

    assert type(learner.model) is kind
    assert learner.env is env


def test_equal_seeds_begin_with_equal_weights(env: PushVecEnv) -> None:
    first, again, other = (weights(make_learner(small_profile(), env, seed).model) for seed in (3, 3, 4))

    assert first == again != other


def test_the_first_pushes_are_as_deep_as_the_profile_says(env: PushVecEnv) -> None:
    profile = small_profile()
    assert isinstance(profile, PpoProfile)

    model = make_learner(profile, env, 3).model

    bias = model.policy.action_net.bias  # type: ignore[union-attr]
    assert isinstance(bias, torch.Tensor)
    assert bias[DEPTH].item() == pytest.approx(profile.settings.depth_bias)


def test_an_algorithm_for_continuous_actions_is_refused_the_published_grid() -> None:
    task = tuned(entry="fixed", action_form="discrete", scenario=scenario_at_station())
    env = PushVecEnv(task, [FakeWorld()])

    with pytest.raises(ConfigError, match="Expected continuous actions for the algorithm sac, got discrete ones"):
        make_learner(small_profile("sac"), env, 3)
    env.close()


def test_exploration_is_set_by_how_far_the_training_is(env: PushVecEnv) -> None:
    profile = small_profile()
    assert isinstance(profile, PpoProfile)
    assert profile.settings.log_std_end is not None
    learner = make_learner(profile, env, 3)

    learner.model.num_timesteps = profile.steps // 2
    set_exploration(learner, profile)

    spread = learner.model.policy.log_std
    assert isinstance(spread, torch.Tensor)
    middle = (profile.settings.log_std_init + profile.settings.log_std_end) / 2
    np.testing.assert_allclose(spread.detach().numpy(), middle, rtol=1e-6)


def test_draws_of_torch_inside_change_nothing_of_those_after() -> None:
    torch.manual_seed(1)
    expected = torch.rand(3).tolist()
    torch.manual_seed(1)
    with undisturbed_draws():
        torch.rand(100)

    assert torch.rand(3).tolist() == expected


def test_moments_are_those_of_the_normalizer(env: PushVecEnv) -> None:
    profile = small_profile()
    bare = msgspec.structs.replace(profile, normalize_observation=False)
    learner = learned(profile, env, 32)

    moments = observation_moments(learner.normalizer)

    assert moments is not None
    mean, variance = moments
    assert mean.shape == variance.shape == (8,)
    assert (variance > 0.0).all()
    assert observation_moments(make_learner(bare, env, 3).normalizer) is None
