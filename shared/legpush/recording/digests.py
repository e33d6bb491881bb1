"""Digests of recorded messages, in the recording itself: a bit that flips later is found, and where."""

from typing import Final, NamedTuple

import msgspec
from msgspec import Struct

from legpush.fields import Name
from legpush.messages import codec
from legpush.messages.common import Count

DIGEST_TOPIC: Final = "recording/digests"

Key = tuple[str, str, int]
"""Which message: topic, incarnation of the sender, sequence."""


class Mark(NamedTuple):
    """What a message was when it was recorded."""

    crc: int
    """CRC-32 of its bytes."""
    place: tuple[int, int] | None
    """Episode and step, where the message has them."""


class Digest(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Marks of messages of one sender under one topic."""

    topic: str
    incarnation: Name
    sequences: tuple[Count, ...]
    crcs: tuple[Count, ...]
    """CRC-32 of each, in the order of `sequences`."""
    places: tuple[tuple[Count, Count] | None, ...]
    """Episode and step of each, where messages have them: a damaged one does not tell."""


class Digests(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Of the messages that were recorded since the last one."""

    digests: tuple[Digest, ...]


class _Placed(Struct, frozen=True):
    """What is looked for in a message of any kind."""

    episode: Count
    step: Count


_PLACED: Final = msgspec.msgpack.Decoder(_Placed)


def mark_of(payload: bytes) -> Mark:
    """The mark of a message that is as it should be."""
    try:
        placed = _PLACED.decode(payload)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return Mark(codec.checksum(payload), None)
    return Mark(codec.checksum(payload), (placed.episode, placed.step))
