"""A session on the network. The only module that imports zenoh.

Every link is explicit: no scouting, no gossip, no shared memory (it leaks when a process is killed). A peer that is not
there yet, or comes back, is connected to within half a second, so the order of starting does not matter. Zenoh's
low-latency transport is off: it loses every message above 64 KiB without a word, such as an observation with a trace.
"""

import logging
import os
import re
import threading
from collections.abc import Callable
from functools import partial
from typing import Any, Final
from zlib import crc32

import zenoh

from legpush.bus.channels import Quality
from legpush.bus.endpoints import Endpoints, listing, prepare
from legpush.bus.links.configuration import configuration_text
from legpush.bus.links.waiting import NobodyThereError, open_when_there
from legpush.bus.links.welcome import require_welcome
from legpush.bus.transport import OnBytes, OnDamaged, OnToken, Sender, Undeclare, ignore
from legpush.errors import EndpointError

NO_COLOUR: Final = "NO_COLOR"
"""Environment variable that keeps escape sequences out of Zenoh's log."""

_SOURCE: Final = re.compile(r"\.? at /\S+\.rs:\d+\.?")
"""The place of an error in the source of Zenoh."""
_IN_USE: Final = re.compile(r"\bEADDRINUSE\b|Address already in use|acquire lock: E(AGAIN|WOULDBLOCK)\b")
_MISSING: Final = re.compile(r"\bENOENT\b|No such file or directory")
_UNREACHED: Final = re.compile(r"Unable to connect to any of")

log = logging.getLogger(__name__)


class ZenohSession:
    """A `legpush.bus.transport.Session` over Zenoh."""

    def __init__(self, endpoints: Endpoints, who: str, stop: threading.Event | None = None) -> None:
        """Open it; `who` is named in errors. A client of routers waits for one of them, until `stop` is set.

        Raises:
            CredentialsError: What listens there refuses the certificate of this process, now or when a router comes.
            EndpointError: One of the endpoints cannot be listened on.
            StopRequestedError: `stop` was set before a router was there.
        """
        require_welcome(endpoints)
        prepare(endpoints)
        self._link_events: Any = None
        try:
            if endpoints.mode == "client":
                stop = stop or threading.Event()
                self._session: Any = open_when_there(partial(_open_client, endpoints), endpoints.connect, stop)
                self._tell_links()
            else:
                self._session = zenoh.open(_config(endpoints))
        except zenoh.ZError as error:
            raise EndpointError(
                f"Expected to listen on {listing(endpoints.listen)} as {who}, but that is not possible: {_why(error)}"
            ) from error

    def _tell_links(self) -> None:
        """Log when the link to the router comes and goes. Zenoh makes it again by itself."""

        def tell(event: zenoh.LinkEvent) -> None:
            if event.kind == zenoh.SampleKind.PUT:
                log.info("linked with the router at %s", event.link.dst)
            else:
                log.warning("the link to the router at %s is gone; it comes again with a router", event.link.dst)

        self._link_events = self._session.info.declare_link_events_listener(_callback(tell), history=True)

    def close(self) -> None:
        """Close all links.

        The events of links end first: a call of Zenoh's that comes while Python ends aborts the process.
        """
        if self._link_events is not None:
            self._link_events.undeclare()
        self._session.close()

    def linked(self) -> tuple[str, ...]:
        """Return the names in the certificates of all processes at the other ends of the links, if they have any."""
        names = (link.auth_identifier for link in self._session.info.links())
        return tuple(str(name) for name in names if name is not None)

    def publisher(self, key: str, quality: Quality) -> Sender:
        """Sends bytes under `key`; those of the lockstep are never dropped on a living link."""
        publisher = self.declare_publisher(key, quality)
        crc_of_key = crc32(key.encode())

        def send(payload: bytes) -> None:
            publisher.put(payload, attachment=crc32(payload, crc_of_key).to_bytes(4, "big"))

        return Sender(send, publisher.undeclare)

    def put(self, key: str, payload: bytes) -> None:
        """Publish bytes once."""
        self._session.put(key, payload, congestion_control=zenoh.CongestionControl.BLOCK, express=True)

    def subscribe(self, key: str, on_bytes: OnBytes, on_damaged: OnDamaged = ignore) -> Undeclare:
        """Call `on_bytes` with key and payload of everything that other processes publish under `key`.

        `on_damaged` is called instead for a message that does not fit its checksum; one without is passed on.
        """

        def take_sample(sample: zenoh.Sample) -> None:
            at, payload, attached = str(sample.key_expr), sample.payload.to_bytes(), sample.attachment
            if attached is None or attached.to_bytes() == checksum(at, payload):
                on_bytes(at, payload)
            else:
                on_damaged(at)

        return self.declare_subscriber(key, take_sample)

    def declare_publisher(self, key: str, quality: Quality) -> Any:
        """Return Zenoh's own publisher, which sends bytes without a checksum."""
        return self._session.declare_publisher(key, **publisher_settings(quality))

    def declare_subscriber(self, key: str, on_sample: Callable[[zenoh.Sample], None]) -> Undeclare:
        """Call `on_sample` with everything that other processes publish under `key`, as Zenoh hands it over."""
        subscriber = self._session.declare_subscriber(key, _callback(on_sample), allowed_origin=zenoh.Locality.REMOTE)
        return partial(_undeclare, subscriber)

    def show_token(self, key: str) -> Undeclare:
        """Show a liveliness token until it is taken back, or this process ends."""
        return partial(_undeclare, self._session.liveliness().declare_token(key))

    def watch_tokens(self, key: str, on_token: OnToken) -> Undeclare:
        """Call `on_token` with a key and whether it lives, for each token now and whenever one comes or goes."""

        def take_sample(sample: zenoh.Sample) -> None:
            on_token(str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)

        watcher = self._session.liveliness().declare_subscriber(key, _callback(take_sample), history=True)
        return partial(_undeclare, watcher)


def checksum(key: str, payload: bytes) -> bytes:
    """Return what is attached to a message: the CRC-32 of its key and payload, four bytes, big-endian.

    TCP and unix sockets lose no byte, but not everything between two processes is a socket: a proxy, a tunnel or a
    memory module with a fault would change a number in a message, and the message would still be valid.
    """
    return crc32(payload, crc32(key.encode())).to_bytes(4, "big")


def _why(error: zenoh.ZError) -> str:
    """Return an error of Zenoh without the places in its source, and what to do where the cause is known."""
    said = _SOURCE.sub("", str(error)).rstrip(".")
    if _IN_USE.search(said):
        cure = "; choose another port with --listen" if "tcp/" in said else ""
        return f"another process listens there{cure} ({said})"
    if _MISSING.search(said):
        return f"the directory does not exist ({said})"
    return said


def _undeclare(declared: Any) -> None:
    declared.undeclare()


def publisher_settings(quality: Quality) -> dict[str, Any]:
    """Return how Zenoh sends messages of this quality."""
    lockstep = quality == "lockstep"
    return {
        "congestion_control": zenoh.CongestionControl.BLOCK if lockstep else zenoh.CongestionControl.DROP,
        "priority": zenoh.Priority.DATA if lockstep else zenoh.Priority.DATA_LOW,
        "reliability": zenoh.Reliability.RELIABLE,
        "express": lockstep,
        "allowed_destination": zenoh.Locality.REMOTE,
    }


def _config(endpoints: Endpoints) -> zenoh.Config:
    return zenoh.Config.from_json5(configuration_text(endpoints))


def log_refused_links() -> None:
    """Write a line to standard output for each handshake of TLS that fails: all that Zenoh says about strangers."""
    before = os.environ.get(NO_COLOUR)
    os.environ[NO_COLOUR] = "1"
    try:
        zenoh.init_log_from_env_or("zenoh_link_tls=warn")
    finally:
        if before is None:
            del os.environ[NO_COLOUR]
        else:
            os.environ[NO_COLOUR] = before


def _open_client(endpoints: Endpoints) -> Any:
    """Open the session of a client of routers, which links with the first one that answers.

    Raises:
        NobodyThereError: None of them answers.
        CredentialsError: One of them does, and refuses the certificate of this process.
    """
    try:
        return zenoh.open(_config(endpoints))
    except zenoh.ZError as error:
        if _UNREACHED.search(str(error)):
            silences = require_welcome(endpoints)
            raise NobodyThereError("; ".join(("none can be reached", *silences))) from error
        raise


def _callback(function: Callable[[Any], None]) -> Any:
    """A callback that runs on a Python thread of its own.

    On the network's thread it would block the link whenever other code holds the interpreter, as OMPL does while it
    solves; after a lease of that, the link is lost.
    """
    return zenoh.handlers.Callback(function, indirect=True)
