"""Messages to MessagePack and back, strictly: what does not match its record is refused with the path of the field."""

from math import isfinite
from typing import Any, Final, TypeVar

import msgpack
import msgspec

from legpush.errors import MessageError

T = TypeVar("T")

MAX_MESSAGE_BYTES: Final = 64 * 1024 * 1024


def encode(message: msgspec.Struct) -> bytes:
    """The message as a MessagePack map; a non-finite number in it is a `MessageError`."""
    plain = msgspec.to_builtins(message, builtin_types=(bytes,))
    _require_finite(plain, "$")
    packed: bytes = msgpack.packb(plain)
    return packed


def decode(payload: bytes, kind: type[T]) -> T:
    """The message of type `kind` in `payload`; `MessageError` names the first field that is wrong."""
    if len(payload) > MAX_MESSAGE_BYTES:
        raise MessageError(f"Expected at most {MAX_MESSAGE_BYTES} bytes, got {len(payload)}")
    try:
        plain = msgpack.unpackb(payload, timestamp=0, strict_map_key=True)
    except (ValueError, msgpack.exceptions.UnpackException, RecursionError) as error:
        raise MessageError(f"Expected one MessagePack map, got {len(payload)} other bytes ({error})") from error
    return convert(plain, kind)


def convert(plain: Any, kind: type[T]) -> T:
    """A record of type `kind` from maps, arrays and plain values; `MessageError` names the first wrong field."""
    try:
        message = msgspec.convert(plain, kind)
    except (msgspec.ValidationError, RecursionError) as error:
        raise MessageError(str(error)) from error
    _require_finite(plain, "$")
    return message


def _require_finite(plain: Any, path: str) -> None:
    """Raise where a float is NaN or infinite; `path` is where `plain` stands in the message."""
    if type(plain) is float:
        if not isfinite(plain):
            raise MessageError(f"Expected a finite number, got {plain} - at `{path}`")
    elif type(plain) is dict:
        for key, value in plain.items():
            _require_finite(value, f"{path}.{key}")
    elif type(plain) in (list, tuple):
        for index, value in enumerate(plain):
            if type(value) is not float or not isfinite(value):
                _require_finite(value, f"{path}[{index}]")
