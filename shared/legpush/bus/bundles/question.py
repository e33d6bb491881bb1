"""Which question a message asks, or answers: told by a look at a few fields, whatever the rest of the message is."""

from typing import Final, NamedTuple, TypeVar

import msgspec
from msgspec import Struct

from legpush.bounds import Count
from legpush.fields import Name

T = TypeVar("T")


class Question(NamedTuple):
    """What a simulator is asked: copies of it are the same question, and its answer names it."""

    agent: str
    """Incarnation of the agent that asks."""
    episode: int
    step: int


class _Sender(Struct, frozen=True):
    incarnation: Name


class _Asking(Struct, frozen=True):
    """The fields of an `Action` that matter here."""

    header: _Sender
    episode: Count
    step: Count


class _Answering(Struct, frozen=True):
    """The fields of an `Observation` or a `Refusal` that matter here."""

    agent_incarnation: Name
    episode: Count
    step: Count


_ASKING: Final = msgspec.msgpack.Decoder(_Asking)
_ANSWERING: Final = msgspec.msgpack.Decoder(_Answering)


def asked_in(payload: bytes) -> Question | None:
    """Return the question that an action asks; None if these bytes are no action."""
    found = _fields(_ASKING, payload)
    return None if found is None else Question(found.header.incarnation, found.episode, found.step)


def answered_in(payload: bytes) -> Question | None:
    """Return the question that an answer answers; None if these bytes are no answer."""
    found = _fields(_ANSWERING, payload)
    return None if found is None else Question(found.agent_incarnation, found.episode, found.step)


def _fields(decoder: msgspec.msgpack.Decoder[T], payload: bytes) -> T | None:
    try:
        return decoder.decode(payload)
    except (msgspec.MsgspecError, ValueError, RecursionError):
        return None
