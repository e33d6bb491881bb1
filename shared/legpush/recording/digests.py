"""Digests of recorded messages, in the recording itself: a bit that flips later is found, and where."""

from typing import Final

from msgspec import Struct

from legpush.messages.common import Count, Name

DIGEST_TOPIC: Final = "recording/digests"


class Digest(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """CRC-32 of messages of one sender under one topic."""

    topic: str
    incarnation: Name
    sequences: tuple[Count, ...]
    crcs: tuple[Count, ...]
    """In the order of `sequences`."""


class Digests(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Of the messages that were recorded since the last one."""

    digests: tuple[Digest, ...]
