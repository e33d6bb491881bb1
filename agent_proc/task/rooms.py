"""Rooms that a task draws at random, and the tasks whose episodes are whole missions in them."""

from dataclasses import fields
from typing import TYPE_CHECKING, Final

import msgspec

from legpush.errors import ConfigError
from legpush.scenarios.random_room import RandomRoom

if TYPE_CHECKING:
    RoomFields = RandomRoom
else:
    RoomFields = msgspec.defstruct(
        "RoomFields",
        [(field.name, field.type, field.default) for field in fields(RandomRoom)],
        frozen=True,
        forbid_unknown_fields=True,
    )
    """The fields of a `RandomRoom` as a record that refuses unknown ones, which a dataclass does not."""

DRAWN: Final = ("mass_kg", "friction")
"""Fields of a domain that a task with random rooms may have: the others are those of the room."""


def room_of(given: RoomFields) -> RandomRoom:
    """Return the room of a file.

    Raises:
        ConfigError: A value is out of range.
    """
    return RandomRoom(**{field.name: getattr(given, field.name) for field in fields(RandomRoom)})


def refuse_missions(given: object) -> None:
    """Refuse a task whose episodes are missions, where an episode has to be a box and its goal.

    `given` is the task's field `random_room`.

    Raises:
        ConfigError: It is such a task; says what learns and compares it.
    """
    if given is not msgspec.UNSET:
        raise ConfigError(
            "Expected a task whose episodes are a box and its goal, got one with `random_room`, whose episodes are "
            "whole missions: learn it in the environment legpush/PushL4-v2, and compare policies on it by a study of "
            "the cell `mission`, as `legpush study run experiments/studies/level_l4.toml` does"
        )
