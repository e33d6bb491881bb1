"""The whole state of a learner between two rollouts as plain data: captured, and restored without running code of it.

Algorithm, networks and optimizers are built from the profile; the data only fill in their numbers.
"""

from collections import deque
from collections.abc import Mapping
from operator import attrgetter
from typing import Any, Final

import numpy as np
import torch
from msgspec import Struct
from numpy.typing import NDArray
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.buffers import ReplayBuffer
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.vec_env import VecNormalize

from agent_proc.learning.env import EnvSnapshot
from agent_proc.learning.learner import Learner
from agent_proc.learning.plain_array import PlainArray, from_plain, to_plain
from agent_proc.learning.random_state import (
    GlobalRandomState,
    Pcg64State,
    global_random_state,
    set_global_random_state,
    set_state,
    state_of,
)

COUNTERS: Final = ("num_timesteps", "_total_timesteps", "_num_timesteps_at_start", "_episode_num", "_n_updates")
"""Attributes of an algorithm that are whole numbers."""
REPLAY: Final = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")
"""Arrays of a replay buffer, (steps, environments, ...)."""
TEMPERATURE: Final = "log_ent_coef"
"""The weight of the entropy that SAC learns, which belongs to no network."""


class OptimizerState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What an optimizer keeps of each parameter, and its learning rate."""

    learning_rate: float
    parameters: tuple[dict[str, PlainArray], ...]
    """By name, such as `exp_avg`; empty before the first update."""


class ReplayState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The steps in a replay buffer."""

    position: int
    """Index of the next step to be written."""
    full: bool
    arrays: dict[str, PlainArray]
    """The part that is filled, for each of `REPLAY`."""


class Moments(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Running mean and variance."""

    mean: PlainArray
    variance: PlainArray
    count: float


class LearnerState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Everything on which the next step of a learner depends."""

    counters: dict[str, int]
    progress_remaining: float
    weights: dict[str, PlainArray]
    temperature: PlainArray | None
    optimizers: dict[str, OptimizerState]
    replay: ReplayState | None
    last: dict[str, PlainArray]
    """What the algorithm saw last: those of `_last` that it keeps."""
    episode_returns: PlainArray
    """Of the last episodes, for the log, like lengths, times and successes."""
    episode_lengths: PlainArray
    episode_times_s: tuple[float, ...]
    episode_successes: tuple[bool, ...]
    moments: dict[str, Moments]
    discounted_returns: PlainArray
    seen: PlainArray
    """Observations before they are normalized."""
    rewards: PlainArray | None
    """The same of the rewards; None before the first step."""
    running_returns: PlainArray
    running_lengths: PlainArray
    n_episodes: int
    random: GlobalRandomState
    action_space: Pcg64State
    environments: tuple[EnvSnapshot, ...]


def capture(learner: Learner) -> LearnerState:
    """Capture everything on which the next step depends; to be called where a rollout begins."""
    model, normalizer, monitor = learner.model, learner.normalizer, learner.monitor
    temperature = getattr(model, TEMPERATURE, None)
    episodes = list(model.ep_info_buffer or ())
    return LearnerState(
        counters={name: getattr(model, name) for name in COUNTERS},
        progress_remaining=float(model._current_progress_remaining),
        weights={name: to_plain(tensor.numpy()) for name, tensor in model.policy.state_dict().items()},
        temperature=to_plain(temperature.detach().numpy()) if isinstance(temperature, torch.Tensor) else None,
        optimizers={name: _optimizer_state(optimizer) for name, optimizer in _optimizers(model).items()},
        replay=_replay_state(model.replay_buffer)
        if isinstance(model, OffPolicyAlgorithm) and model.replay_buffer is not None
        else None,
        last={name: to_plain(array) for name, array in _last(model).items() if array is not None},
        episode_returns=to_plain(np.array([episode["r"] for episode in episodes], dtype=np.float32)),
        episode_lengths=to_plain(np.array([episode["l"] for episode in episodes], dtype=np.int32)),
        episode_times_s=tuple(float(episode["t"]) for episode in episodes),
        episode_successes=tuple(bool(success) for success in model.ep_success_buffer or ()),
        moments={
            name: Moments(mean=to_plain(np.asarray(rms.mean)), variance=to_plain(np.asarray(rms.var)), count=rms.count)
            for name, rms in _running(normalizer).items()
        },
        discounted_returns=to_plain(normalizer.returns),
        seen=to_plain(np.asarray(normalizer.old_obs)),
        rewards=to_plain(normalizer.old_reward) if len(normalizer.old_reward) else None,
        running_returns=to_plain(monitor.episode_returns),
        running_lengths=to_plain(monitor.episode_lengths),
        n_episodes=monitor.episode_count,
        random=global_random_state(),
        action_space=state_of(model.action_space.np_random),
        environments=learner.env.snapshot(),
    )


def restore(learner: Learner, state: LearnerState) -> None:
    """Return a learner that was made from the same profile, and its environments, to a captured state.

    Raises:
        ConfigError: It was captured with another number of environments.
        PeerError: A repeated episode leads to another state.
        ValueError: The state does not fit the learner; the message names the first array that does not.
    """
    model, normalizer, monitor = learner.model, learner.normalizer, learner.monitor
    learner.env.restore(state.environments)
    for name in COUNTERS:
        setattr(model, name, _of(state.counters, name, "counters"))
    model._current_progress_remaining = state.progress_remaining
    _restore_weights(model, state)
    if isinstance(model, OffPolicyAlgorithm) and model.replay_buffer is not None:
        if state.replay is None:
            raise ValueError("at `replay`: expected the steps of a replay buffer, got none")
        _restore_replay(model.replay_buffer, state.replay)
    n = learner.env.num_envs
    for name, like in _last_likes(model, n).items():
        if name in state.last:
            setattr(model, name, from_plain(state.last[name], like, f"last.{name}"))
    _restore_episodes(model, state)
    restore_moments(normalizer, state)
    seen = np.zeros((n, *(normalizer.observation_space.shape or ())), dtype=np.float32)
    per_env = np.zeros(n, dtype=np.float32)
    normalizer.returns = from_plain(state.discounted_returns, np.zeros(n), "discounted_returns")
    normalizer.old_obs = from_plain(state.seen, seen, "seen")
    if state.rewards is not None:
        normalizer.old_reward = from_plain(state.rewards, per_env, "rewards")
    monitor.episode_returns = from_plain(state.running_returns, per_env, "running_returns")
    monitor.episode_lengths = from_plain(state.running_lengths, per_env.astype(np.int32), "running_lengths")
    monitor.episode_count = state.n_episodes
    set_state(model.action_space.np_random, state.action_space)
    set_global_random_state(state.random)


def restore_networks(model: BaseAlgorithm, state: LearnerState) -> None:
    """Give an algorithm the weights of a captured state.

    Raises:
        ValueError: They do not fit its networks; the message names the first array that does not.
    """
    weights = model.policy.state_dict()
    if weights.keys() != state.weights.keys():
        raise ValueError(f"at `weights`: expected {', '.join(weights)}, got {', '.join(state.weights) or 'nothing'}")
    model.policy.load_state_dict(
        {name: _tensor(state.weights[name], like, f"weights.{name}") for name, like in weights.items()}
    )


def restore_moments(normalizer: VecNormalize, state: LearnerState) -> None:
    """Give a normalizer the running mean and variance of a captured state.

    Raises:
        ValueError: They do not fit; the message names the first array that does not.
    """
    for name, rms in _running(normalizer).items():
        moments = _of(state.moments, name, "moments")
        rms.mean, rms.var = (
            from_plain(plain, np.asarray(rms.mean), f"moments.{name}")[()] for plain in (moments.mean, moments.variance)
        )
        rms.count = moments.count


# -- parts -------------------------------------------------------------------------------------------------------------


def _of(values: Mapping[str, Any], name: str, where: str) -> Any:
    """The value of a name; one that is missing is a ValueError."""
    if name not in values:
        raise ValueError(f"at `{where}`: expected `{name}`, got {', '.join(values) or 'nothing'}")
    return values[name]


def _optimizers(model: BaseAlgorithm) -> dict[str, torch.optim.Optimizer]:
    """The optimizers of an algorithm by their dotted names."""
    parts = {name: attrgetter(name)(model) for name in model.get_parameters()}
    return {name: part for name, part in parts.items() if isinstance(part, torch.optim.Optimizer)}


def _optimizer_state(optimizer: torch.optim.Optimizer) -> OptimizerState:
    (group,) = optimizer.param_groups
    return OptimizerState(
        learning_rate=float(group["lr"]),
        parameters=tuple(
            {name: to_plain(tensor.numpy()) for name, tensor in optimizer.state.get(parameter, {}).items()}
            for parameter in group["params"]
        ),
    )


def _restore_weights(model: BaseAlgorithm, state: LearnerState) -> None:
    """Networks, temperature and optimizers."""
    restore_networks(model, state)
    temperature = getattr(model, TEMPERATURE, None)
    if isinstance(temperature, torch.Tensor):
        if state.temperature is None:
            raise ValueError("at `temperature`: expected the weight of the entropy, got none")
        with torch.no_grad():
            temperature.copy_(_tensor(state.temperature, temperature, "temperature"))
    for name, optimizer in _optimizers(model).items():
        _restore_optimizer(optimizer, _of(state.optimizers, name, "optimizers"), f"optimizers.{name}")


def _restore_optimizer(optimizer: torch.optim.Optimizer, state: OptimizerState, where: str) -> None:
    (group,) = optimizer.param_groups
    if len(state.parameters) != len(group["params"]):
        raise ValueError(f"at `{where}`: expected {len(group['params'])} parameters, got {len(state.parameters)}")
    names = {"step", "exp_avg", "exp_avg_sq"}
    kept = {}
    for index, (parameter, plain) in enumerate(zip(group["params"], state.parameters, strict=True)):
        if plain and plain.keys() != names:
            raise ValueError(f"at `{where}`: expected {', '.join(sorted(names))}, got {', '.join(plain)}")
        if plain:
            likes = {name: torch.zeros(()) if name == "step" else parameter for name in plain}
            kept[index] = {name: _tensor(plain[name], likes[name], f"{where}.{name}") for name in plain}
    fresh = optimizer.state_dict()
    fresh["param_groups"][0]["lr"] = state.learning_rate
    optimizer.load_state_dict({"state": kept, "param_groups": fresh["param_groups"]})


def _replay_state(buffer: ReplayBuffer) -> ReplayState:
    return ReplayState(
        position=buffer.pos,
        full=buffer.full,
        arrays={name: to_plain(getattr(buffer, name)[: buffer.size()]) for name in REPLAY},
    )


def _restore_replay(buffer: ReplayBuffer, state: ReplayState) -> None:
    if not 0 <= state.position < buffer.buffer_size:
        raise ValueError(f"at `replay.position`: expected less than {buffer.buffer_size}, got {state.position}")
    buffer.pos, buffer.full = state.position, state.full
    for name in REPLAY:
        filled = getattr(buffer, name)[: buffer.size()]
        filled[...] = from_plain(_of(state.arrays, name, "replay"), filled, f"replay.{name}")


def _last(model: BaseAlgorithm) -> dict[str, Any]:
    return {name: getattr(model, name) for name in ("_last_obs", "_last_original_obs", "_last_episode_starts")}


def _last_likes(model: BaseAlgorithm, n: int) -> dict[str, NDArray[Any]]:
    """An array like each of `_last`, with `n` environments."""
    seen = np.zeros((n, *(model.observation_space.shape or ())), dtype=np.float32)
    return {"_last_obs": seen, "_last_original_obs": seen, "_last_episode_starts": np.zeros(n, dtype=np.bool_)}


def _restore_episodes(model: BaseAlgorithm, state: LearnerState) -> None:
    """Returns, lengths, times and successes of the last episodes."""
    n = len(state.episode_times_s)
    returns = from_plain(state.episode_returns, np.zeros(n, dtype=np.float32), "episode_returns")
    lengths = from_plain(state.episode_lengths, np.zeros(n, dtype=np.int32), "episode_lengths")
    episodes = zip(returns, lengths, state.episode_times_s, strict=True)
    model.ep_info_buffer = deque(
        ({"r": total, "l": length, "t": time_s} for total, length, time_s in episodes), maxlen=model._stats_window_size
    )
    model.ep_success_buffer = deque(state.episode_successes, maxlen=model._stats_window_size)


def _running(normalizer: VecNormalize) -> dict[str, Any]:
    return {"ret": normalizer.ret_rms, **({"obs": normalizer.obs_rms} if normalizer.norm_obs else {})}


def _tensor(plain: PlainArray, like: torch.Tensor, name: str) -> torch.Tensor:
    return torch.from_numpy(from_plain(plain, like.detach().numpy(), name))
