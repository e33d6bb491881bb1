"""Builds the learning algorithms from a profile, and takes their policies out of them."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np
import torch
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.utils import LinearSchedule
from stable_baselines3.common.vec_env import VecEnv, VecMonitor, VecNormalize

from agent_proc.learning.env import EnvSnapshot
from agent_proc.policies.actor import Normalizer
from agent_proc.policies.sb3.arguments import policy_arguments
from agent_proc.profiles.profile import AnyProfile, OffPolicySettings, PpoProfile, PpoSettings, Td3Profile
from legpush.arrays import Floats
from legpush.errors import ConfigError

DEPTH: Final = 3
"""Index of the depth among the elements of a variable-entry action."""


class Rewindable(Protocol):
    """Environments whose state can be saved and restored."""

    @property
    def num_envs(self) -> int:
        """Number of environments."""

    def get_attr(self, attr_name: str) -> list[Any]:
        """The attribute of each environment."""

    def snapshot(self) -> tuple[EnvSnapshot, ...]:
        """The present state as plain data."""

    def restore(self, snapshots: Sequence[EnvSnapshot]) -> object:
        """Return to a saved state."""


@dataclass(frozen=True, kw_only=True)
class Learner:
    """An algorithm and the layers of its environments."""

    model: BaseAlgorithm
    normalizer: VecNormalize
    monitor: VecMonitor
    """Counts episodes, below the normalizer."""
    env: Rewindable
    """The environments, below the monitor."""


def undisturbed_draws() -> AbstractContextManager[None]:
    """Keep the random draws of torch inside this context from changing those after it."""
    return torch.random.fork_rng(devices=[])


def make_learner(profile: AnyProfile, env: VecEnv, seed: int) -> Learner:
    """Make a new learner.

    Raises:
        ConfigError: The algorithm cannot act in the environment.
    """
    monitor = VecMonitor(env)
    normalizer = VecNormalize(
        monitor,
        norm_obs=profile.normalize_observation,
        norm_reward=profile.normalize_reward,
        gamma=profile.settings.gamma,
    )
    if profile.algorithm != "ppo" and type(env.action_space).__name__ != "Box":
        raise ConfigError(f"Expected continuous actions for the algorithm {profile.algorithm}, got discrete ones")
    common: dict[str, Any] = {"seed": seed, "device": "cpu"}
    if isinstance(profile, PpoProfile):
        model = _ppo(profile, profile.settings, normalizer, common)
    else:
        model = _off_policy(profile, profile.settings, normalizer, common)
    return Learner(model=model, normalizer=normalizer, monitor=monitor, env=env)  # type: ignore[arg-type]


def set_exploration(learner: Learner, profile: AnyProfile) -> None:
    """Set the spread of exploration that the profile gives for the present step; called before each rollout."""
    spread = getattr(learner.model.policy, "log_std", None)
    if not isinstance(profile, PpoProfile) or profile.settings.log_std_end is None or spread is None:
        return
    done = min(1.0, learner.model.num_timesteps / profile.steps)
    first, last = profile.settings.log_std_init, profile.settings.log_std_end
    spread.requires_grad_(False)
    spread.fill_(first + done * (last - first))


def _ppo(profile: PpoProfile, settings: PpoSettings, env: VecNormalize, common: dict[str, Any]) -> BaseAlgorithm:
    rate = settings.learning_rate
    model = PPO(
        "MlpPolicy",
        env,
        learning_rate=LinearSchedule(rate, rate / 10, 1.0) if settings.decay_learning_rate else rate,
        n_steps=settings.n_steps,
        batch_size=min(settings.batch_size, settings.n_steps * env.num_envs),
        n_epochs=settings.n_epochs,
        gamma=settings.gamma,
        gae_lambda=settings.gae_lambda,
        clip_range=settings.clip_range,
        ent_coef=settings.entropy_weight,
        policy_kwargs=policy_arguments(profile),
        **common,
    )
    bias = getattr(model.policy.action_net, "bias", None)
    if isinstance(bias, torch.nn.Parameter) and env.action_space.shape == (DEPTH + 1,):
        with torch.no_grad():
            bias[DEPTH] = settings.depth_bias
    return model


def _off_policy(
    profile: AnyProfile, settings: OffPolicySettings, env: VecNormalize, common: dict[str, Any]
) -> BaseAlgorithm:
    shared: dict[str, Any] = {
        "learning_rate": settings.learning_rate,
        "gamma": settings.gamma,
        "batch_size": settings.batch_size,
        "buffer_size": settings.buffer_size,
        "learning_starts": settings.learning_starts,
        "gradient_steps": settings.gradient_steps,
        "train_freq": 1,
        "tau": settings.tau,
        "policy_kwargs": policy_arguments(profile),
        **common,
    }
    if isinstance(profile, Td3Profile):
        shape = env.action_space.shape or ()
        noise = NormalActionNoise(np.zeros(shape), np.full(shape, profile.settings.action_noise))
        return TD3("MlpPolicy", env, action_noise=noise, **shared)
    return SAC("MlpPolicy", env, **shared)


def observation_moments(normalizer: VecNormalize) -> tuple[Floats, Floats] | None:
    """Mean and variance of the normalizer of observations, (n,) each; None if they are not normalized."""
    if not normalizer.norm_obs:
        return None
    rms = normalizer.obs_rms
    if not isinstance(rms, RunningMeanStd):
        raise TypeError(f"Expected one array of observations, got {type(rms).__name__}")
    return rms.mean.copy(), rms.var.copy()


def set_observation_moments(normalizer: VecNormalize, moments: Normalizer, n_observations: int) -> None:
    """Let the normalizer of observations go on from mean and variance of that many observations."""
    rms = normalizer.obs_rms
    if not isinstance(rms, RunningMeanStd):
        raise TypeError(f"Expected one array of observations, got {type(rms).__name__}")
    rms.mean, rms.var, rms.count = moments.mean.copy(), moments.variance.copy(), float(n_observations)
