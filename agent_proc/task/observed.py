"""What a policy of a task observes: its vector and its bounds."""

import numpy as np
from numpy.typing import NDArray

from agent_proc.frames.push_view import PushView
from agent_proc.task.config import TaskConfig
from legpush.arrays import Floats
from legpush.errors import ConfigError


def n_observed(task: TaskConfig) -> int:
    """Number of elements of the observation."""
    return sum(len(term.AXES) for term in task.observation_terms.values())


def observation_bounds(task: TaskConfig) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Lowest and highest values of the observation, (n,) each.

    Raises:
        ConfigError: A term has another number of bounds than axes, or bounds that nothing can be mapped from.
    """
    low, high = _bounds(task)
    if task.scaling == "bounds":
        if not (np.isfinite(high - low) & (high > low)).all():
            raise ConfigError("Expected finite bounds that differ with the scaling `bounds`, got others")
        low, high = np.full_like(low, -1.0), np.full_like(high, 1.0)
    return low.astype(np.float32), high.astype(np.float32)


def observe(task: TaskConfig, view: PushView) -> NDArray[np.float32]:
    """The observation vector, (n,).

    Raises:
        ConfigError: A term returned another number of elements than it has axes.
    """
    mirror_sign = view.mirror_sign if task.mirrored else 1.0
    parts = []
    for name, term in task.observation_terms.items():
        part = term.scale * np.asarray(term.read(view, mirror_sign))
        if part.shape != (len(term.AXES),):
            raise ConfigError(f"at `observation.{name}`: expected {len(term.AXES)} elements, got shape {part.shape}")
        parts.append(part)
    values = np.concatenate(parts)
    if task.scaling == "bounds":
        low, high = _bounds(task)
        values = 2.0 * (values - low) / (high - low) - 1.0
    return values.astype(np.float32)


def _bounds(task: TaskConfig) -> tuple[Floats, Floats]:
    """Lowest and highest values before they are mapped, (n,) each."""
    pairs = []
    for name, term in task.observation_terms.items():
        ends = np.array([term.scale * end for end in term.limits(task.scenario)])
        if ends.shape != (2, len(term.AXES)):
            raise ConfigError(f"at `observation.{name}`: expected {len(term.AXES)} bounds, got shape {ends.shape[1:]}")
        pairs.append(np.sort(ends, axis=0))
    low, high = np.concatenate(pairs, axis=1)
    return low, high
