"""The bus: typed publishers and subscriptions over Zenoh, and who is there. The only module that imports zenoh.

Every link is explicit: no scouting, no gossip, no shared memory (it leaks when a process is killed). A peer that is not
there yet, or comes back, is connected to within half a second, so the order of starting does not matter.
"""

import json
import logging
import secrets
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from types import TracebackType
from typing import Any, Final, Self

import zenoh
from msgspec import Struct

from legpush.bus import channels, keys
from legpush.bus.channels import Channel, M
from legpush.bus.endpoints import Endpoints, listing
from legpush.bus.faults import BadChannel, Faults, fate_table
from legpush.bus.liveliness import LEASE_S, Roster
from legpush.bus.ports import Publisher, Subscription
from legpush.bus.recorder_taps import Taps
from legpush.bus.tally import Tally
from legpush.bus.validation import Intake
from legpush.errors import EndpointError, MessageError
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Header, Name, Role
from legpush.messages.telemetry import Copies, Fact, Origin, Status

log = logging.getLogger(__name__)

RETRY: Final = {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 1.5}

OnPeer = Callable[[Role, str, str, bool], None]
"""Role, name, incarnation, alive; called on a thread of the bus."""


class Bus:
    """One process on the bus; a context manager that connects on entry and always closes.

    `roster` tells who is there, `tally` counts every message that was refused or dropped, by cause, `taps` have copies
    of what is published for recorders.
    """

    def __init__(
        self,
        run: str,
        role: Role,
        name: str,
        endpoints: Endpoints,
        faults: Faults | None = None,
        *,
        recorded: bool = False,
    ) -> None:
        """`recorded`: a recorder is about to come, and is to have everything from the start."""
        self.run = run
        self.role = role
        self.name = name
        self.endpoints = endpoints
        self.incarnation = secrets.token_hex(6)
        self.roster = Roster()
        self.tally = Tally()
        self._faults = faults if faults is not None and faults.probability > 0.0 else None
        self._on_peer: list[OnPeer] = []
        self._closing = ExitStack()
        self._recorded = recorded
        origin = Origin(role=role, name=name, incarnation=self.incarnation)
        self.taps = Taps(origin, self._send_copies)

    def __enter__(self) -> Self:
        session = self._open()
        self._closing.callback(session.close)
        self._session = session
        self._open_taps()
        watcher = session.liveliness().declare_subscriber(
            keys.liveliness(self.run, "*", "*", "*"), _callback(self._take_token), history=True
        )
        self._closing.callback(watcher.undeclare)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._closing.close()

    def publisher(self, channel: Channel[M]) -> Publisher[M]:
        """What sends on `channel`; lockstep channels go through the injected faults, if there are any."""
        lockstep = channel.quality == "lockstep"
        publisher = self._session.declare_publisher(
            channel.key,
            congestion_control=zenoh.CongestionControl.BLOCK if lockstep else zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.DATA if lockstep else zenoh.Priority.DATA_LOW,
            reliability=zenoh.Reliability.RELIABLE,
            express=lockstep,
            allowed_destination=zenoh.Locality.REMOTE,
        )
        self._closing.callback(publisher.undeclare)
        note = partial(self.taps.own.buffer.note, channel.key) if channel.is_copied else None
        if not lockstep or self._faults is None:
            return Publisher(self._header, publisher.put, note)
        bad_channel = BadChannel(fate_table(self._faults, channel.key), publisher.put)
        self._closing.callback(bad_channel.close)
        return Publisher(self._header, bad_channel.send, note)

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Recordings of this run get this file as well."""
        self.taps.own.buffer.attach(Fact(name=name, media_type=media_type, data=data))

    def put(self, key: str, payload: bytes) -> None:
        """Publish bytes as they are, valid or not."""
        self._session.put(key, payload, congestion_control=zenoh.CongestionControl.BLOCK, express=True)

    def subscribe(self, channel: Channel[M], into: Subscription[M] | None = None) -> Subscription[M]:
        """The messages of `channel` from now on; whatever is not valid is counted in `tally` and logged."""
        subscription = into or Subscription(channel, self.tally)
        self._receive(channel, subscription.put)
        return subscription

    def follow(self, role: Role, name: str | None = None) -> None:
        """Keep `roster` up to date on the status of these peers, their heartbeat, from now on."""
        self._receive(channels.statuses(self.run, role, name or "*"), lambda _: None)

    def _receive(self, channel: Channel[M], put: Callable[[M], None]) -> None:
        intake = Intake(channel, self.run, self.tally)

        def take(sample: zenoh.Sample) -> None:
            key, payload = str(sample.key_expr), sample.payload.to_bytes()
            message = intake.take(key, payload)
            if message is not None:
                header = message.header
                if channel.is_copied:
                    self.taps.heard(header, key, payload)
                doing = message.phase if isinstance(message, Status) else None
                self.roster.heard(header.role, header.name, header.incarnation, doing)
                put(message)

        subscriber = self._session.declare_subscriber(
            channel.key, _callback(take), allowed_origin=zenoh.Locality.REMOTE
        )
        self._closing.callback(subscriber.undeclare)

    def announce(self) -> None:
        """Show the liveliness token: this process is ready. Call it after subscribing, once."""
        token = self._session.liveliness().declare_token(
            keys.liveliness(self.run, self.role, self.name, self.incarnation)
        )
        self._closing.callback(token.undeclare)

    def watch(self, on_peer: OnPeer) -> None:
        """Call `on_peer` whenever a peer's liveliness token comes or goes, and now for those already there."""
        self._on_peer.append(on_peer)
        for peer in self.roster.live():
            on_peer(peer.role, peer.name, peer.incarnation, True)

    def _open_taps(self) -> None:
        """Declared before anything is published, so that the farewell comes after everything else."""
        self._copies = self.publisher(channels.copies(self.run, self.role, self.name))
        self._receive(channels.taken(self.run, self.role, self.name), self.taps.take)
        self._closing.callback(self.taps.close)
        if self._recorded:
            self.taps.own.start()

    def _send_copies(self, build: Callable[[Header], Copies]) -> Copies:
        return self._copies.send(build)

    def _header(self, sequence: int) -> Header:
        """The only place where a header is made."""
        return Header(
            protocol=PROTOCOL_VERSION,
            run=self.run,
            role=self.role,
            name=self.name,
            incarnation=self.incarnation,
            sequence=sequence,
        )

    def _take_token(self, sample: zenoh.Sample) -> None:
        """A liveliness token came or went: note it, and tell who watches."""
        key = str(sample.key_expr)
        try:
            token = _parse_token(key)
        except MessageError as error:
            self.tally.add(error.cause, f"{key}: {error}")
            return
        if token.incarnation == self.incarnation:
            return
        alive = sample.kind == zenoh.SampleKind.PUT
        self.roster.token(token.role, token.name, token.incarnation, alive)
        if token.role == "recorder" and self.role != "recorder":
            self.taps.meet({peer.incarnation for peer in self.roster.live("recorder")})
        for on_peer in self._on_peer:
            on_peer(token.role, token.name, token.incarnation, alive)

    def _open(self) -> zenoh.Session:
        """A session on these endpoints; `EndpointError` where one cannot be listened on."""
        try:
            session = zenoh.open(_config(self.endpoints))
        except zenoh.ZError as error:
            raise EndpointError(
                f"Expected to listen on {listing(self.endpoints.listen)} as {self.role} {self.name}, but that is not "
                f"possible; is another {self.role} running there, and does the directory exist? ({error})"
            ) from error
        log.info(
            "run %s, incarnation %s, listening on %s, connecting to %s",
            self.run,
            self.incarnation,
            listing(self.endpoints.listen),
            listing(self.endpoints.connect),
        )
        return session


def _config(endpoints: Endpoints) -> zenoh.Config:
    config = zenoh.Config()
    settings: dict[str, Any] = {
        "mode": "peer",
        "listen/endpoints": list(endpoints.listen),
        "listen/timeout_ms": 0,
        "listen/exit_on_failure": True,
        "connect/endpoints": list(endpoints.connect),
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "connect/retry": RETRY,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "open/return_conditions/connect_scouted": False,
        "transport/shared_memory/enabled": False,
        "transport/link/tx/lease": round(1e3 * LEASE_S),
    }
    for path, value in settings.items():
        config.insert_json5(path, json.dumps(value))
    return config


def _callback(function: Callable[[zenoh.Sample], None]) -> Any:
    """Called on a Python thread of its own.

    On the network's thread it would block the link whenever other code holds the interpreter, as OMPL does while it
    solves; after a lease of that, the link is lost.
    """
    return zenoh.handlers.Callback(function, indirect=True)


class _Token(Struct, frozen=True, kw_only=True):
    """What a liveliness key says."""

    role: Role
    name: Name
    incarnation: Name


def _parse_token(key: str) -> _Token:
    """The last three segments of a liveliness key; `MessageError` if they name no process."""
    role, name, incarnation = key.split("/")[-3:]
    return codec.convert({"role": role, "name": name, "incarnation": incarnation}, _Token)
