"""What the bus needs of a network: a session that sends bytes, receives bytes, and shows who is alive."""

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

from legpush.bus.channels import Quality

OnBytes = Callable[[str, bytes], None]
"""Key and payload; called on a thread of the session."""
OnDamaged = Callable[[str], None]
"""Key of a message whose bytes changed on the way; called on a thread of the session."""
OnToken = Callable[[str, bool], None]
"""Key of a liveliness token, and whether it lives; called on a thread of the session."""
Undeclare = Callable[[], None]
"""Takes a declaration back. Keep it as long as the declaration is needed: a session may drop one that nobody keeps."""


def ignore(key: str) -> None:
    """An `OnDamaged` that tells nobody."""


class Sender(NamedTuple):
    """Sends bytes under one key."""

    send: Callable[[bytes], None]
    undeclare: Undeclare


class Session(Protocol):
    """Open links to other processes."""

    def close(self) -> None:
        """Close all links."""

    def linked(self) -> Sequence[str]:
        """Return the names in the certificates of all processes at the other ends of the links, if they have any."""

    def publisher(self, key: str, quality: Quality) -> Sender:
        """Sends bytes under `key`."""

    def put(self, key: str, payload: bytes) -> None:
        """Publish bytes once."""

    def subscribe(self, key: str, on_bytes: OnBytes, on_damaged: OnDamaged = ignore) -> Undeclare:
        """Call `on_bytes` for everything that other processes publish under `key`, which may hold wildcards.

        `on_damaged` is called instead for a message that does not fit its checksum.
        """

    def show_token(self, key: str) -> Undeclare:
        """Show a liveliness token until it is taken back, or this process ends."""

    def watch_tokens(self, key: str, on_token: OnToken) -> Undeclare:
        """Call `on_token` for each token that lives now, and whenever one comes or goes."""
