"""Makes Gymnasium's `max_episode_steps` the length of an episode, which the task then ends by itself."""

from typing import Any, Protocol, cast

import gymnasium
from gymnasium.utils import RecordConstructorArgs

from legpush.errors import ConfigError


class Task(Protocol):
    """What the episodes of an environment are."""

    @property
    def max_steps(self) -> int:
        """Push cycles after which an episode is truncated."""

    def with_max_steps(self, n: int) -> "Task":
        """Return the task with another length (`ConfigError` if there can be no such length)."""


class HasTask(Protocol):
    """An environment with a task."""

    task: Task


class EpisodeLimit(gymnasium.Wrapper[Any, Any, Any, Any], RecordConstructorArgs):
    """Gives the environment the limit that Gymnasium truncates by, so that the last step says its `ending`."""

    def __init__(self, env: gymnasium.Env[Any, Any], usual: int) -> None:
        """Wrap an environment; `usual` is the `max_episode_steps` of its id, which holds if none was given.

        Raises:
            ConfigError: The task has longer episodes, or another length was given as `max_steps`.
        """
        RecordConstructorArgs.__init__(self, usual=usual)
        gymnasium.Wrapper.__init__(self, env)
        spec, inner = env.spec, cast(HasTask, env.unwrapped)
        limit = None if spec is None else spec.max_episode_steps
        if spec is None or limit is None:
            return
        if limit == usual:
            if (n := inner.task.max_steps) > limit:
                raise ConfigError(
                    f"Expected at most {limit} push cycles for an episode of {spec.id}, got {n} for max_steps; give "
                    f"max_episode_steps={n}"
                )
        elif spec.kwargs.get("max_steps", limit) != limit:
            raise ConfigError(
                f"Expected one length of an episode, got {spec.kwargs['max_steps']} for max_steps and {limit} for "
                "max_episode_steps"
            )
        else:
            inner.task = inner.task.with_max_steps(limit)
