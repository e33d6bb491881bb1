"""From bytes to a message: every payload that comes in passes here, and what is wrong is counted, never raised."""

from typing import Any, Generic

from legpush.bus.channels import Channel, M
from legpush.bus.tally import Tally
from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Header


class Validation(Generic[M]):
    """The gate of one channel: size, MessagePack, protocol version, finite numbers, schema, run, sender; in this order.

    Causes it counts: `oversize`, `malformed`, `version`, `not_finite`, `foreign_run`, `sender`.
    """

    def __init__(self, channel: Channel[M], run: str, tally: Tally) -> None:
        self._channel = channel
        self._run = run
        self._tally = tally

    def validate_payload(self, key: str, payload: bytes) -> M | None:
        """Return the valid message in `payload`; None if it was refused and counted."""
        message = codec.decode_own(payload, self._channel.kind)
        if message is None or message.header.protocol != PROTOCOL_VERSION:
            message = self._decode_any(key, payload)
        return message if message is not None and self._welcome(key, message.header) else None

    def _decode_any(self, key: str, payload: bytes) -> M | None:
        """Return the message in `payload`, in any encoding; None if it is not valid, counted by its first fault."""
        try:
            plain = codec.unpack(payload)
            version = _protocol_of(plain)
            if version != PROTOCOL_VERSION:
                self._tally.add("version", f"{key}: expected protocol {PROTOCOL_VERSION}, got {version}")
                return None
            return codec.convert(plain, self._channel.kind)
        except MessageError as error:
            self._tally.add(error.cause, f"{key}: {error}")
            return None

    def _welcome(self, key: str, header: Header) -> bool:
        """Whether the sender may say this here."""
        if header.run != self._run:
            self._tally.add("foreign_run", f"{key}: expected run {self._run}, got {header.run} from {header.name}")
            return False
        if "*" in key:
            self._tally.add("sender", f"{key}: expected one key, got one with a wildcard from {header.name}")
            return False
        role, key_of = self._channel.sender, self._channel.key_of
        if role is not None and header.role != role:
            self._tally.add("sender", f"{key}: expected a message of a {role}, got one of {header.role} {header.name}")
            return False
        if key_of is not None and key_of(header) != key:
            self._tally.add("sender", f"{key}: {header.role} {header.name} has to use {key_of(header)}")
            return False
        return True


def _protocol_of(plain: Any) -> int:
    """The protocol version that a message claims, before its schema is looked at; `MessageError` if it claims none."""
    header = plain.get("header") if isinstance(plain, dict) else None
    version = header.get("protocol") if isinstance(header, dict) else None
    if type(version) is not int:
        raise MessageError(f"Expected an integer, got {type(version).__name__} - at `$.header.protocol`")
    return version
