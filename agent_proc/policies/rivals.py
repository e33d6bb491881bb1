"""The dumbest rivals of a policy: always the same action, or any action, until an episode of a task would end."""

import hashlib
from itertools import product
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from agent_proc.frames.push_view import PushView
from agent_proc.task.action import CHOICES, n_actions, to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from legpush.errors import ConfigError
from legpush.messages.stepping import Push

Rival = Literal["zero", "random", "constant"]
RIVALS: Final[tuple[Rival, ...]] = ("zero", "random", "constant")
SHAPES: Final = (-0.6, 0.0, 0.6)
"""w1 and w2 of the grid of constant actions, in [-1, 1] (our choice, as the next two)."""
LEGS: Final = (-1.0, 1.0)
DEPTHS: Final = (-1.0, -0.5, 0.0, 0.5, 1.0)
DISCRETE: Final = (1, 4, 7)
"""The same as indices of the published grid."""

Action = tuple[float, ...]


class ConstantPolicy:
    """Always the same action, until an episode of its task would end."""

    def __init__(self, task: TaskConfig, action: Action) -> None:
        """Make the policy.

        Raises:
            ConfigError: The action has not as many elements as those of the task.
        """
        if len(action) != n_actions(task):
            raise ConfigError(f"Expected an action of {n_actions(task)} numbers, as the task has, got {list(action)}")
        self._task = task
        self._action = _as_array(task, action)

    def decide(self, view: PushView) -> Push | None:
        """The same push, or None if nothing is left to do."""
        return None if has_arrived(self._task, view) else to_push(self._action, self._task, view)


class RandomPolicy:
    """An action drawn uniformly, from a hash of time and place of the box: the same view gives the same push."""

    def __init__(self, task: TaskConfig) -> None:
        self._task = task

    def decide(self, view: PushView) -> Push | None:
        """Any push, or None if nothing is left to do."""
        if has_arrived(self._task, view):
            return None
        box = view.box_w
        seen = np.array([view.world.tick, box.x_m, box.y_m, box.yaw_rad], dtype=np.float64)
        rng = np.random.default_rng(int.from_bytes(hashlib.sha256(seen.tobytes()).digest()[:8], "little"))
        n = n_actions(self._task)
        if self._task.action_form == "discrete":
            return to_push(rng.integers(CHOICES), self._task, view)
        return to_push(rng.uniform(-1.0, 1.0, n), self._task, view)


def make_rival(name: Rival, task: TaskConfig, action: Action) -> ConstantPolicy | RandomPolicy:
    """Make the rival with this name; `action` is that of the constant one.

    Raises:
        ConfigError: The action does not fit.
    """
    if name == "random":
        return RandomPolicy(task)
    return ConstantPolicy(task, zero_action(task) if name == "zero" else action)


def zero_action(task: TaskConfig) -> Action:
    """The middle of every range: zeros, or the middle of the published grid with FL."""
    return (CHOICES[0] // 2, CHOICES[1] // 2, 0) if task.action_form == "discrete" else (0.0,) * n_actions(task)


def action_grid(task: TaskConfig) -> list[Action]:
    """The constant actions among which the best one is searched: 90 with variable entry, 18 otherwise."""
    if task.action_form == "discrete":
        return [tuple(map(float, action)) for action in product(DISCRETE, DISCRETE, (0, 1))]
    depths = (DEPTHS,) if task.entry == "variable" else ()
    return list(product(SHAPES, SHAPES, LEGS, *depths))


def _as_array(task: TaskConfig, action: Action) -> NDArray[np.int64] | NDArray[np.float64]:
    if task.action_form == "discrete":
        return np.array([round(value) for value in action], dtype=np.int64)
    return np.array(action, dtype=np.float64)
