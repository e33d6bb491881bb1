"""Runs a trained policy: it decides about pushes as in training, but without exploring."""

import logging
from typing import Any, Protocol

from numpy.typing import NDArray

from agent_proc.frames.push_view import PushView
from agent_proc.policies.actor import Float32s, Normalizer
from agent_proc.policies.folder import PolicyFolder, policy_path, read_policy
from agent_proc.policies.reach import Reach, reach_of
from agent_proc.task.action import to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from agent_proc.task.observed import n_observed, observe
from legpush.errors import PolicyError
from legpush.messages.stepping import Push

log = logging.getLogger(__name__)


class Network(Protocol):
    """Computes actions; the `Actor` of a policy folder, or the model in a file of Stable-Baselines3."""

    def act(self, observation: Float32s) -> NDArray[Any]:
        """The action for a normalized observation, (n,)."""


class NetworkPolicy:
    """A policy whose network was trained on a task."""

    def __init__(
        self,
        task: TaskConfig,
        network: Network,
        normalizer: Normalizer | None,
        origin: str,
        reach: Reach | None = None,
    ) -> None:
        """Make the policy; its error messages begin with `origin`.

        It stops beyond `reach`, if one is given, with a warning the first time.

        Raises:
            PolicyError: The normalizer does not fit the observation of the task.
        """
        n_seen = n_observed(task)
        if normalizer is not None and len(normalizer.mean) != n_seen:
            raise PolicyError(
                f"{origin}: expected {n_seen} means, one for each element of the observation "
                f"({', '.join(task.observation)}), got {len(normalizer.mean)}"
            )
        self.task = task
        self._network = network
        self._normalizer = normalizer
        self._origin = origin
        self._reach = reach
        self._level = logging.WARNING
        """Of the next message."""

    def decide(self, view: PushView) -> Push | None:
        """The next push, or None if an episode of training would have ended here, or it was never trained here."""
        if has_arrived(self.task, view):
            return None
        if self._reach is not None and not self._reach.covers(view):
            log.log(
                self._level,
                "%s stops: the box is %s, and it was trained up to %s",
                self._origin,
                reach_of(view),
                self._reach,
            )
            self._level = logging.INFO
            return None
        observation = observe(self.task, view)
        if self._normalizer is not None:
            observation = self._normalizer.apply(observation)
        return to_push(self._network.act(observation), self.task, view)


class LearnedPolicy(NetworkPolicy):
    """The policy of a folder."""

    def __init__(self, folder: PolicyFolder, name: str) -> None:
        """Make the policy of a folder that messages call `name`."""
        self.card = folder.card
        super().__init__(folder.card.task, folder.actor(), folder.normalizer, name, folder.card.reach)


def require_single_face(policy: object) -> None:
    """Require a policy that pushes the face that it is given: in missions, the path of the box decides about the face.

    Raises:
        PolicyError: It was trained on a task in which an action chooses the face.
    """
    task = getattr(policy, "task", None)
    if isinstance(task, TaskConfig) and task.changes_face:
        raise PolicyError(
            "Expected a policy for a mission whose task has `changes_face = false`, since the path of the box decides "
            "about the face, got one that chooses the face: evaluate it with `legpush compare --task`"
        )


def load_learned(name_or_path: str) -> LearnedPolicy:
    """Load a shipped policy by its name, or the policy in a folder.

    Raises:
        PolicyError: There is none, or one of its files cannot be used; the message names the file.
    """
    path = policy_path(name_or_path)
    return LearnedPolicy(read_policy(path), str(path))
