"""Messages to MessagePack and back, strictly: what does not match its record is refused with the path of the field."""

from math import isfinite
from typing import Any, Final, TypeVar
from zlib import crc32

import msgpack
import msgspec

from legpush.errors import MessageError

T = TypeVar("T")

MAX_MESSAGE_BYTES: Final = 64 * 1024 * 1024


def encode(message: msgspec.Struct) -> bytes:
    """The message as a MessagePack map; a non-finite number or more than `MAX_MESSAGE_BYTES` is a `MessageError`."""
    plain = msgspec.to_builtins(message, builtin_types=(bytes,))
    _require_finite(plain, "$")
    packed: bytes = msgpack.packb(plain)
    _require_size(packed)
    return packed


def decode(payload: bytes, kind: type[T]) -> T:
    """The message of type `kind` in `payload`; `MessageError` names the first field that is wrong."""
    return convert(unpack(payload), kind)


def checksum(payload: bytes) -> int:
    """CRC-32 of a message's bytes."""
    return crc32(payload)


def unpack(payload: bytes) -> Any:
    """The maps, arrays and plain values in `payload`; `MessageError` where it is not MessagePack or too large."""
    _require_size(payload)
    try:
        return msgpack.unpackb(payload, timestamp=0, strict_map_key=True)
    except (ValueError, msgpack.exceptions.UnpackException, RecursionError) as error:
        why = str(error) or type(error).__name__
        raise MessageError(f"Expected one MessagePack map, got {len(payload)} other bytes ({why})") from error


def convert(plain: Any, kind: type[T]) -> T:
    """A record of type `kind` from maps, arrays and plain values; `MessageError` names the first wrong field."""
    try:
        _require_finite(plain, "$")
        return msgspec.convert(plain, kind)
    except (msgspec.ValidationError, RecursionError) as error:
        raise MessageError(str(error)) from error


def _require_size(payload: bytes) -> None:
    """Raise where a message is larger than any message may be."""
    if len(payload) > MAX_MESSAGE_BYTES:
        raise MessageError(f"Expected at most {MAX_MESSAGE_BYTES} bytes, got {len(payload)}", "oversize")


def _require_finite(plain: Any, path: str) -> None:
    """Raise where a float is NaN or infinite; `path` is where `plain` stands in the message."""
    if type(plain) is float:
        if not isfinite(plain):
            raise MessageError(f"Expected a finite number, got {plain} - at `{path}`", "not_finite")
    elif type(plain) is dict:
        for key, value in plain.items():
            _require_finite(value, f"{path}.{key}")
    elif type(plain) in (list, tuple):
        for index, value in enumerate(plain):
            if type(value) is not float or not isfinite(value):
                _require_finite(value, f"{path}[{index}]")
