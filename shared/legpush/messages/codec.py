"""Encodes messages as MessagePack and decodes them strictly: an error names the field that does not match."""

import re
import threading
from functools import cache
from math import isfinite
from typing import Any, Final, TypeVar, cast
from zlib import crc32

import msgpack
import msgspec

from legpush.errors import MessageError
from legpush.messages.float_bounds import bounds_every_float

T = TypeVar("T")

MAX_MESSAGE_BYTES: Final = 64 * 1024 * 1024
MAX_PARTS: Final = 2**20
"""Most maps and arrays in a message: empty ones need a byte each in the payload, and 70 times as much in memory."""
_MAKING: Final = threading.RLock()
"""msgspec looks at the fields of a type when it is first used. A thread that decodes the type meanwhile crashes."""
_ENCODER: Final = msgspec.msgpack.Encoder()
_SUSPECT: Final = re.compile(rb"\xcb[\x7f\xff][\xf0-\xff]")
"""How every float64 begins that is not finite. Other bytes rarely look like that: one place in 500 000 at random."""


def encode(message: msgspec.Struct) -> bytes:
    """Return the message as a MessagePack map.

    Raises:
        MessageError: A number is not finite, an integer has more than 64 bits, the message is longer than
            `MAX_MESSAGE_BYTES`, or there is no memory for it.
    """
    try:
        packed = _ENCODER.encode(message)
        if _SUSPECT.search(packed) is not None:
            _require_finite(msgspec.to_builtins(message, builtin_types=(bytes,)), "$")
    except (TypeError, ValueError, OverflowError, RecursionError, MemoryError) as error:
        kind = type(message).__name__
        raise MessageError(f"Expected a {kind} that MessagePack can hold ({type(error).__name__}: {error})") from error
    _require_size(packed)
    return packed


def decode(payload: bytes, kind: type[T]) -> T:
    """Return the message of type `kind` in `payload`.

    Raises:
        MessageError: The payload is not such a message; the error names the first wrong field.
    """
    message = decode_own(payload, kind)
    return convert(unpack(payload), kind) if message is None else message


def decode_own(payload: bytes, kind: type[T]) -> T | None:
    """Return the message if the payload is, byte for byte, what `encode` makes of a valid one; else None.

    This is the quick way for what legpush itself has encoded. None says nothing about other encodings of a valid
    message, such as one with its fields in another order: `unpack` and `convert` decide about these.
    """
    decoder = _own_decoder(cast(Any, kind))
    if decoder is None or len(payload) > min(MAX_PARTS, MAX_MESSAGE_BYTES):
        return None
    try:
        message: T = decoder.decode(payload)
        # The decoder passes a repeated key, and takes an integer for a float: then these are other bytes.
        return message if _ENCODER.encode(message) == payload else None
    except (msgspec.MsgspecError, ValueError, OverflowError, RecursionError):
        return None


@cache
def _decoder(kind: Any) -> msgspec.msgpack.Decoder[Any]:
    """The decoder of this type, which is made before any thread decodes this type."""
    with _MAKING:
        return msgspec.msgpack.Decoder(kind)


@cache
def _own_decoder(kind: Any) -> msgspec.msgpack.Decoder[Any] | None:
    """A decoder of this type; None if it would let a number pass that is not finite, since the type has no bounds."""
    with _MAKING:
        return _decoder(kind) if bounds_every_float(kind) else None


def checksum(payload: bytes) -> int:
    """Return the CRC-32 of a message's bytes."""
    return crc32(payload)


def unpack(payload: bytes) -> Any:
    """Return the maps, arrays and plain values in `payload`.

    Raises:
        MessageError: The payload is not MessagePack, or it is too large.
    """
    _require_size(payload)
    try:
        # Only a long payload can have too many parts, so that only it pays for counting them.
        count = _Count() if len(payload) > MAX_PARTS else None
        return msgpack.unpackb(
            payload,
            timestamp=0,
            strict_map_key=True,
            object_pairs_hook=_map if count is None else count.map,
            list_hook=None if count is None else count.array,
        )
    except (ValueError, msgpack.exceptions.UnpackException, RecursionError) as error:
        why = str(error) or type(error).__name__
        raise MessageError(f"Expected one MessagePack map, got {len(payload)} other bytes ({why})") from error


def _map(pairs: list[tuple[Any, Any]]) -> dict[Any, Any]:
    """Return a map; one with a repeated key is refused, since decoders differ in which value they take."""
    fields = dict(pairs)
    if len(fields) != len(pairs):
        seen: set[Any] = set()
        repeated = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise ValueError(f"a map with the key {repeated!r} twice")
    return fields


class _Count:
    """Counts the maps and arrays of a message while it is unpacked."""

    def __init__(self) -> None:
        self._n = 0

    def map(self, pairs: list[tuple[Any, Any]]) -> dict[Any, Any]:
        """Count a map."""
        return _map(self.array(pairs))

    def array(self, elements: list[T]) -> list[T]:
        """Count an array."""
        self._n += 1
        if self._n > MAX_PARTS:
            raise ValueError(f"more than {MAX_PARTS} maps and arrays")
        return elements


def convert(plain: Any, kind: type[T]) -> T:
    """Return a record of type `kind`, made from maps, arrays and plain values.

    Raises:
        MessageError: The values do not fit the record; the error names the first wrong field.
    """
    try:
        _require_finite(plain, "$")
        _decoder(cast(Any, kind))
        return msgspec.convert(plain, kind)
    except (msgspec.ValidationError, RecursionError) as error:
        raise MessageError(str(error)) from error


def _require_size(payload: bytes) -> None:
    """Refuse a payload that is longer than `MAX_MESSAGE_BYTES` (`MessageError`)."""
    if len(payload) > MAX_MESSAGE_BYTES:
        raise MessageError(f"Expected at most {MAX_MESSAGE_BYTES} bytes, got {len(payload)}", "oversize")


def _require_finite(plain: Any, path: str) -> None:
    """Refuse a float that is NaN or infinite (`MessageError`); `path` is the place of `plain` in the message."""
    if type(plain) is float:
        if not isfinite(plain):
            raise MessageError(f"Expected a finite number, got {plain} - at `{path}`", "not_finite")
    elif type(plain) is dict:
        for key, value in plain.items():
            _require_finite(value, f"{path}.{key}")
    elif type(plain) in (list, tuple) and not _has_finite_sum(plain):
        for index, value in enumerate(plain):
            if type(value) is not float or not isfinite(value):
                _require_finite(value, f"{path}[{index}]")


def _has_finite_sum(items: Any) -> bool:
    """Whether these are numbers, all of them finite: then so is their sum, unless they are very large."""
    try:
        return isfinite(sum(items))
    except (TypeError, OverflowError):
        return False
