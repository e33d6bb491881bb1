"""Whether a training can begin with a trained policy, and in what the two differ."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from agent_proc.policies.card import Card
from agent_proc.profiles.profile import AnyProfile
from agent_proc.task.config import TaskConfig
from agent_proc.task.elements import action_elements
from legpush.errors import PolicyError


def require_alike(profile: AnyProfile, task: TaskConfig, card: Card, where: str | Path) -> None:
    """Require a policy whose actor fits a training with this profile on this task.

    Raises:
        PolicyError: Algorithm, network, observation or action differ; says in what.
    """
    for what, expected, got in (
        ("algorithm", profile.algorithm, card.profile.algorithm),
        ("hidden layers", profile.network.hidden, card.profile.network.hidden),
        ("activation", profile.network.activation, card.profile.network.activation),
        ("normalize_observation", profile.normalize_observation, card.profile.normalize_observation),
        ("action", *map(_acted, (task, card.task))),
    ):
        if expected != got:
            raise PolicyError(
                f"{where}: expected a policy with the {what} of this training, {_text(expected)}, got {_text(got)}"
            )
    if differences := list(_differences(task, card.task)):
        raise PolicyError(
            f"{where}: expected a policy with the observation of this training, got one {'; '.join(differences)}"
        )


def _differences(mine: TaskConfig, theirs: TaskConfig) -> Iterator[str]:
    """Say in what the observation of a policy's task differs from that of a training."""
    lacking = [name for name in mine.observation if name not in theirs.observation]
    more = [name for name in theirs.observation if name not in mine.observation]
    if lacking:
        yield f"without {', '.join(lacking)}"
    if more:
        yield f"that also has {', '.join(more)}"
    for name in ("mirrored", "scaling"):
        yield from _other(name, getattr(mine, name), getattr(theirs, name))
    for name, settings in mine.observation.items():
        others = theirs.observation.get(name, settings)
        for setting in settings:
            yield from _other(f"{name}.{setting}", settings[setting], others.get(setting))
    if not (lacking or more):
        yield from _other("the order", [*mine.observation], [*theirs.observation])


def _other(name: str, mine: Any, theirs: Any) -> Iterator[str]:
    if mine != theirs:
        yield f"with {name} = {_text(theirs)} in place of {_text(mine)}"


def _acted(task: TaskConfig) -> list[str]:
    return [element.name for element in action_elements(task)]


def _text(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)
