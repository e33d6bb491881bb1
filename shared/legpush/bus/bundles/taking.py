"""Takes bundles from a session, and counts what is none."""

from collections.abc import Callable

from legpush.bus.tally import Tally
from legpush.bus.transport import Session, Undeclare
from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.bundle import Bundle

OnBundle = Callable[[str, Bundle], None]
"""Key and bundle; called on a thread of the session."""


def take_bundles(session: Session, key: str, tally: Tally, on_bundle: OnBundle) -> Undeclare:
    """Call `on_bundle` for each bundle under `key`; anything else is counted in `tally`."""

    def take(at: str, payload: bytes) -> None:
        try:
            bundle = codec.decode(payload, Bundle)
        except MessageError as error:
            tally.add(error.cause, f"{at}: {error}")
            return
        on_bundle(at, bundle)

    def refuse_damaged(at: str) -> None:
        tally.add("damaged", f"{at}: expected the bytes that were sent, got others by the checksum")

    return session.subscribe(key, take, refuse_damaged)
