"""Runs a trained policy: it decides about pushes as in training, but without exploring."""

import io
import pickle
import threading
import zipfile
from typing import Any, Final

import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.save_util import load_from_zip_file
from stable_baselines3.common.utils import ConstantSchedule
from stable_baselines3.ppo import MlpPolicy as PpoPolicy
from stable_baselines3.sac import MlpPolicy as SacPolicy
from stable_baselines3.td3 import MlpPolicy as Td3Policy

from agent_proc.frames.push_view import PushView
from agent_proc.policies.folder import (
    CARD_FILE,
    NETWORKS_FILE,
    NORMALIZER_FILE,
    Normalizer,
    PolicyFolder,
    policy_path,
    read_policy,
)
from agent_proc.policies.networks import policy_arguments, require_small_networks
from agent_proc.task.action import action_space, to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.ending import is_done
from agent_proc.task.observation import observation_space, observe
from legpush.errors import PolicyError
from legpush.messages.stepping import Push

NETWORKS: Final[dict[str, type[BasePolicy]]] = {"ppo": PpoPolicy, "sac": SacPolicy, "td3": Td3Policy}


class NetworkPolicy:
    """A policy whose networks were trained with Stable-Baselines3 on a task."""

    def __init__(self, task: TaskConfig, networks: BasePolicy, normalizer: Normalizer | None, origin: str) -> None:
        """Make the policy; its error messages begin with `origin`.

        Raises:
            PolicyError: The normalizer does not fit the observation of the task.
        """
        n_seen = int(np.prod(observation_space(task).shape))
        if normalizer is not None and len(normalizer.mean) != n_seen:
            raise PolicyError(
                f"{origin}: expected {n_seen} means, one for each element of the observation `{task.observation}`, "
                f"got {len(normalizer.mean)}"
            )
        self._task = task
        self._networks = networks
        self._normalizer = normalizer
        # Networks of Stable-Baselines3 keep the distribution of their last action: one thread at a time.
        self._lock = threading.Lock()

    def decide(self, view: PushView) -> Push | None:
        """The next push, or None if an episode of training would have ended here."""
        if is_done(self._task, view):
            return None
        observation = observe(self._task, view)
        if self._normalizer is not None:
            observation = self._normalizer.apply(observation)
        with self._lock:
            action, _ = self._networks.predict(observation, deterministic=True)
        return to_push(action, self._task, view)


class LearnedPolicy(NetworkPolicy):
    """The policy of a folder; its networks are read as plain arrays, so a folder from elsewhere runs no code."""

    def __init__(self, folder: PolicyFolder, name: str) -> None:
        """Make the policy of a folder that messages call `name`.

        Raises:
            PolicyError: Networks or normalizer do not fit the task on the card.
        """
        self.card = folder.card
        task = folder.card.task
        networks = _networks(folder, observation_space(task), name)
        super().__init__(task, networks, folder.normalizer, f"{name}/{NORMALIZER_FILE}")


def load_learned(name_or_path: str) -> LearnedPolicy:
    """Load a shipped policy by its name, or the policy in a folder.

    Raises:
        PolicyError: There is none, or one of its files cannot be used; the message names the file.
    """
    path = policy_path(name_or_path)
    return LearnedPolicy(read_policy(path), str(path))


def _networks(folder: PolicyFolder, seen: spaces.Box, name: str) -> BasePolicy:
    profile = folder.card.profile
    require_small_networks(profile.network, int(np.prod(seen.shape)), f"{name}/{CARD_FILE}")
    arguments: dict[str, Any] = policy_arguments(profile)
    networks = NETWORKS[profile.algorithm](seen, action_space(folder.card.task), ConstantSchedule(0.0), **arguments)
    path = f"{name}/{NETWORKS_FILE}"
    try:
        _, weights, _ = load_from_zip_file(io.BytesIO(folder.networks), device="cpu", load_data=False)
    except (zipfile.BadZipFile, pickle.UnpicklingError, RuntimeError, ValueError, EOFError) as error:
        raise PolicyError(f"{path}: expected a policy of Stable-Baselines3 ({_first_line(error)})") from error
    if weights is None or "policy" not in weights:
        raise PolicyError(f"{path}: expected weights named `policy`, got {', '.join(weights or ()) or 'none'}")
    try:
        networks.load_state_dict(dict(weights["policy"]))
    except RuntimeError as error:
        space = f"{int(np.prod(seen.shape))} observations and {action_space(folder.card.task)}"
        raise PolicyError(
            f"{path}: expected networks {profile.network.hidden} for {space}, as on its card: {_reason(error)}"
        ) from error
    networks.set_training_mode(False)
    torch.set_num_threads(1)
    return networks


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]


def _reason(error: Exception) -> str:
    """The first detail in the message of torch."""
    lines = str(error).splitlines()
    return lines[1].strip() if len(lines) > 1 else lines[0]
