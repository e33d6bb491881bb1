"""Rivals that choose without looking at the box: always the same action, any action, or both legs in turn.

As for every policy, an action is in its mirror image on the other side of the line, goes no deeper than to the goal,
and an episode ends by the rule of its task.
"""

import hashlib
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from agent_proc.frames.push_view import PushView, seen_from
from agent_proc.task.action import CHOICES, deepest_push_m, n_actions, to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from legpush.errors import ConfigError
from legpush.messages.stepping import Push
from legpush.scene.conventions import FrontLeg
from legpush.scene.names import Face

SHAPES: Final = (-0.6, 0.0, 0.6)
"""w1 and w2 of the grid of constant actions, in [-1, 1] (our choice, as the next two)."""
LEGS: Final = (-1.0, 1.0)
DEPTHS: Final = (-1.0, -0.5, 0.0, 0.5, 1.0)
FACES: Final = (0.0, 0.5, 1.0)
"""The present face, the one to the left, the opposite one: but for the first, the robot walks before every push."""
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


class AlternatePolicy:
    """Both legs in turn, FL first, with w1 and w2 in their middle and the deepest push that the task allows here."""

    def __init__(self, task: TaskConfig) -> None:
        self._task = task

    def decide(self, view: PushView) -> Push | None:
        """The next push, or None if nothing is left to do."""
        if has_arrived(self._task, view):
            return None
        last = view.world.push
        return middle_push(self._task, view, "FR" if last is not None and last.leg == "FL" else "FL")


def middle_push(task: TaskConfig, view: PushView, leg: FrontLeg, face: Face | None = None) -> Push:
    """The deepest push that a task allows with a leg, with w1 and w2 in their middle."""
    there = view if face is None else seen_from(view, face)
    depth_m = deepest_push_m(task, there) if task.entry == "variable" else task.fixed_depth_m
    return Push(w1=0.5, w2=0.5, leg=leg, depth_m=depth_m, face=there.face)


def require_variable_depth(task: TaskConfig, rival: str) -> None:
    """Require a task whose actions choose the depth: the rival has depths of its own.

    Raises:
        ConfigError: All pushes of the task have one depth.
    """
    if task.entry != "variable":
        raise ConfigError(
            f"Expected a task with variable entry for the rival {rival}, got one with pushes of one depth"
        )


def zero_action(task: TaskConfig) -> Action:
    """The middle of every range: zeros, or the middle of the published grid with FL."""
    return (CHOICES[0] // 2, CHOICES[1] // 2, 0) if task.action_form == "discrete" else (0.0,) * n_actions(task)


def action_grid(task: TaskConfig) -> list[Action]:
    """The constant actions among which the best one is searched: 18, times 5 depths, times 3 changes of the face."""
    if task.action_form == "discrete":
        return [tuple(map(float, action)) for action in product(DISCRETE, DISCRETE, (0, 1))]
    depths = (DEPTHS,) if task.entry == "variable" else ()
    faces = (FACES,) if task.changes_face else ()
    return list(product(SHAPES, SHAPES, LEGS, *depths, *faces))


def _as_array(task: TaskConfig, action: Action) -> NDArray[np.int64] | NDArray[np.float64]:
    if task.action_form == "discrete":
        return np.array([round(value) for value in action], dtype=np.int64)
    return np.array(action, dtype=np.float64)
