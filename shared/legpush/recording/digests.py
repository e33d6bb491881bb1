"""Digests of recorded messages, kept in the recording itself. They show whether and where a bit flipped later."""

from typing import Final, NamedTuple

import msgspec
from msgspec import Struct

from legpush.bounds import Count
from legpush.fields import Name
from legpush.messages import codec

DIGEST_TOPIC: Final = "recording/digests"

Key = tuple[str, str, int]
"""Identifies a message: topic, incarnation of the sender, sequence."""


class Mark(NamedTuple):
    """The digest of a message when it was recorded."""

    crc: int
    """CRC-32 of its bytes."""
    place: tuple[int, int] | None
    """Episode and step, if the message has them."""


class Digest(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The marks of messages of one sender under one topic."""

    topic: str
    incarnation: Name
    sequences: tuple[Count, ...]
    crcs: tuple[Count, ...]
    """CRC-32 of each message, in the order of `sequences`."""
    places: tuple[tuple[Count, Count] | None, ...]
    """Episode and step of each message that has them. Kept here since they cannot be read from a damaged message."""


class Digests(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The digests of the messages that were recorded since the last record of this type."""

    digests: tuple[Digest, ...]


class _Placed(Struct, frozen=True):
    """The fields that are looked for in a message of any type."""

    episode: Count
    step: Count


_PLACED: Final = msgspec.msgpack.Decoder(_Placed)


def mark_of(payload: bytes) -> Mark:
    """Return the mark of an undamaged message."""
    try:
        placed = _PLACED.decode(payload)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return Mark(codec.checksum(payload), None)
    return Mark(codec.checksum(payload), (placed.episode, placed.step))
