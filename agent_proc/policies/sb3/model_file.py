"""Loads a policy from the files of Stable-Baselines3: `model.save`, and `VecNormalize.save` for its normalizer.

Loading either file runs the pickled code in it: load only files that you trust. A policy folder has no such risk.
Algorithm and spaces are first checked by the plain text in the model file, so that most other files are refused before
anything is unpickled. That text says only what the file claims, so this check is no protection.
"""

import json
import pickle
import threading
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.vec_env import VecNormalize

from agent_proc.policies.actor import Float32s, Normalizer
from agent_proc.policies.learned import NetworkPolicy
from agent_proc.policies.sb3.arguments import use_one_thread
from agent_proc.policies.sb3.spaces import action_space, observation_space
from agent_proc.task.config import TaskConfig
from agent_proc.task.file import load_task
from legpush.errors import PolicyError
from legpush.plugins import why_not_loaded

ALGORITHMS: Final[dict[str, type[BaseAlgorithm]]] = {
    "stable_baselines3.common.policies": PPO,
    "stable_baselines3.sac.policies": SAC,
    "stable_baselines3.td3.policies": TD3,
}
"""The class that loads a model, by the module of its policy; A2C uses that of PPO, DDPG that of TD3."""
NAMES: Final = ("tuned", "paper-text")
"""Built-in tasks that a model can have learned."""


@cache
def tasks() -> tuple[TaskConfig, ...]:
    """The tasks that a model can have learned; its spaces decide which one."""
    return tuple(
        replace(load_task(name), entry=entry, action_form=form)
        for name in NAMES
        for entry, form in (("variable", "continuous"), ("fixed", "continuous"), ("fixed", "discrete"))
    )


class ModelNetwork:
    """The network of a model, as Stable-Baselines3 evaluates it."""

    def __init__(self, networks: BasePolicy) -> None:
        self._networks = networks
        # Networks of Stable-Baselines3 keep the distribution of their last action: one thread at a time.
        self._lock = threading.Lock()

    def act(self, observation: Float32s) -> NDArray[Any]:
        """The action for a normalized observation, (n,)."""
        with self._lock:
            action, _ = self._networks.predict(observation, deterministic=True)
        return action


def load_sb3_file(path: Path, normalizer: Path | None) -> NetworkPolicy:
    """Load the policy of a model; its observations and actions follow from its spaces.

    Everything else is that of the built-in task with these spaces. `normalizer` is the file of the `VecNormalize` with
    which the model was trained, None if it was trained without one.

    Raises:
        PolicyError: A file is not of the expected kind; the message names it.
    """
    use_one_thread()
    with _loading(path, "a model saved by Stable-Baselines3"):
        networks = _networks(path)
        task = _task(networks, path)
    moments = None if normalizer is None else _normalizer(normalizer)
    return NetworkPolicy(task, ModelNetwork(networks), moments, str(normalizer))


@contextmanager
def _loading(path: Path, expected: str) -> Iterator[None]:
    """Surround the loading of a file. The pickles in it may raise anything, which becomes a `PolicyError`."""
    try:
        yield
    except PolicyError:
        raise
    except (Exception, SystemExit) as error:
        raise PolicyError(f"{path}: expected {expected} that can be loaded here ({why_not_loaded(error)})") from error


def _networks(path: Path) -> BasePolicy:
    with zipfile.ZipFile(path) as archive:
        plain = json.loads(archive.read("data"))
    module = plain["policy_class"]["__module__"]
    if module not in ALGORITHMS:
        raise PolicyError(f"{path}: expected a model of PPO, A2C, SAC, TD3 or DDPG, got a policy of {module}")
    _check_text(plain, path)
    networks = ALGORITHMS[module].load(path, device="cpu").policy
    networks.set_training_mode(False)
    return networks


def _check_text(plain: dict[str, Any], path: Path) -> None:
    """Check the shapes of the spaces, as the text beside their pickles states them.

    Raises:
        PolicyError: No task has these spaces.
    """
    seen, done = (tuple(plain[name]["_shape"]) for name in ("observation_space", "action_space"))
    kind = str(plain["action_space"][":type:"])
    for task in tasks():
        action = action_space(task)
        if (observation_space(task).shape, action.shape, str(type(action))) == (seen, done, kind):
            return
    raise _other_spaces(path, f"{seen} and {done} of {kind}")


def _task(networks: BasePolicy, path: Path) -> TaskConfig:
    """The first task with these spaces."""
    for task in tasks():
        seen, done = observation_space(task).shape, action_space(task)
        if networks.observation_space.shape == seen and networks.action_space == done:
            return task
    raise _other_spaces(path, f"{networks.observation_space.shape} and {networks.action_space}")


def _other_spaces(path: Path, got: str) -> PolicyError:
    sizes = " or ".join(f"{observation_space(load_task(name)).shape} ({name})" for name in NAMES)
    actions = ", ".join(dict.fromkeys(str(action_space(task)) for task in tasks()))
    return PolicyError(f"{path}: expected observations of shape {sizes} and one of the actions {actions}, got {got}")


def _normalizer(path: Path) -> Normalizer:
    with _loading(path, "a file of `VecNormalize.save`"):
        with path.open("rb") as file:
            loaded = pickle.load(file)  # noqa: S301 - the user's own, as its documentation says
        if not isinstance(loaded, VecNormalize) or not loaded.norm_obs:
            raise PolicyError(f"{path}: expected a `VecNormalize` with norm_obs, got {type(loaded).__name__}")
        rms: Any = loaded.obs_rms
        return Normalizer(
            mean=rms.mean.astype(np.float64),
            variance=rms.var.astype(np.float64),
            clip=float(loaded.clip_obs),
            epsilon=float(loaded.epsilon),
        )
