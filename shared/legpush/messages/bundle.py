"""Several messages in one: what is sent to, or comes from, several simulators of one process in the same moment."""

from typing import Annotated, Final

from msgspec import Meta, Struct

from legpush.bounds import MAX_SIMULATORS

MAX_KEY: Final = 512
"""Most characters of a key; the longest has four names."""

Key = Annotated[str, Meta(min_length=1, max_length=MAX_KEY)]


class Part(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A message, byte for byte, and the key under which it would be published alone."""

    key: Key
    payload: bytes


class Bundle(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Messages that travel together. Each has a header of its own, and is judged as if it had come alone."""

    parts: Annotated[tuple[Part, ...], Meta(min_length=1, max_length=MAX_SIMULATORS)]
