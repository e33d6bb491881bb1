"""The bus: typed publishers and subscriptions over Zenoh, and who is there. The only module that imports zenoh.

Every link is explicit: no scouting, no gossip, no shared memory (it leaks when a process is killed). A peer that is not
there yet, or comes back, is connected to within half a second, so the order of starting does not matter.
"""

import json
import logging
import queue
import secrets
import threading
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from types import TracebackType
from typing import Any, Final, Generic, Self

import zenoh
from msgspec import Struct

from legpush import channels, codec, keys
from legpush.channels import Channel, M
from legpush.endpoints import Endpoints, listing
from legpush.errors import EndpointError, MessageError
from legpush.faults import BadChannel, Faults, fate_table
from legpush.intake import Intake
from legpush.messages import PROTOCOL_VERSION, Copies, Fact, Header, Name, Origin, Role, Status, Taken
from legpush.roster import LEASE_S, Roster
from legpush.tally import Tally
from legpush.tap import Tap, TapBuffer

log = logging.getLogger(__name__)

INBOX_SIZE: Final = 1024
"""Messages that wait to be taken; beyond that they are refused, so that a flood cannot fill the memory."""
RETRY: Final = {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 1.5}

OnPeer = Callable[[Role, str, str, bool], None]
"""Role, name, incarnation, alive; called on a thread of the bus."""


class Publisher(Generic[M]):
    """Sends the messages of one channel, each with the next header."""

    def __init__(
        self,
        header: Callable[[int], Header],
        send: Callable[[bytes], None],
        note: Callable[[int, bytes], None] | None = None,
    ) -> None:
        """`note` is told sequence and bytes of each message before it is sent."""
        self._header = header
        self._send = send
        self._note = note
        self._sequence = 0
        self._lock = threading.Lock()

    def send(self, build: Callable[[Header], M]) -> M:
        """Send what `build` makes of the header it is given; a non-finite or oversize message is a `MessageError`."""
        with self._lock:
            message = build(self._header(self._sequence))
            payload = codec.encode(message)
            if self._note is not None:
                self._note(self._sequence, payload)
            self._sequence += 1
            self._send(payload)
        return message


class Subscription(Generic[M]):
    """The valid messages of one channel, in the order in which they came."""

    def __init__(self, channel: Channel[M], tally: Tally) -> None:
        self._key = channel.key
        self._tally = tally
        self._inbox: queue.Queue[M] = queue.Queue(INBOX_SIZE)

    def put(self, message: M) -> None:
        """Called by the bus; never blocks."""
        try:
            self._inbox.put_nowait(message)
        except queue.Full:
            self._tally.add("overflow", f"{self._key}: expected at most {INBOX_SIZE} waiting messages")

    def next(self, timeout_s: float) -> M | None:
        """The next message, or None if none comes within `timeout_s`; 0 looks without waiting."""
        try:
            return self._inbox.get(block=timeout_s > 0.0, timeout=timeout_s)
        except queue.Empty:
            return None

    def drain(self) -> list[M]:
        """All messages that are waiting, without waiting for more."""
        messages = []
        while (message := self.next(0.0)) is not None:
            messages.append(message)
        return messages


class Bus:
    """One process on the bus; a context manager that connects on entry and always closes.

    `roster` tells who is there, `tally` counts every message that was refused or dropped, by cause, `tap` has copies of
    what is published for recorders.
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
        self._witnessed: set[Role] = set()
        origin = Origin(role=role, name=name, incarnation=self.incarnation)
        self.tap = Tap(TapBuffer(origin), self._send_copies)
        self._taps = {origin.incarnation: self.tap}

    def __enter__(self) -> Self:
        session = self._open()
        self._closing.callback(session.close)
        self._session = session
        self._open_tap()
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
        note = partial(self.tap.buffer.note, channel.key) if channel.is_copied else None
        if not lockstep or self._faults is None:
            return Publisher(self._header, publisher.put, note)
        bad_channel = BadChannel(fate_table(self._faults, channel.key), publisher.put)
        self._closing.callback(bad_channel.close)
        return Publisher(self._header, bad_channel.send, note)

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Recordings of this run get this file as well."""
        self.tap.buffer.attach(Fact(name=name, media_type=media_type, data=data))

    def put(self, key: str, payload: bytes) -> None:
        """Publish bytes as they are, valid or not."""
        self._session.put(key, payload, congestion_control=zenoh.CongestionControl.BLOCK, express=True)

    def subscribe(self, channel: Channel[M]) -> Subscription[M]:
        """The messages of `channel` from now on; whatever is not valid is counted in `tally` and logged."""
        subscription = Subscription(channel, self.tally)
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
                if channel.is_copied and header.role in self._witnessed:
                    self._note_heard(header, key, payload)
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

    def _open_tap(self) -> None:
        """Declared before anything is published, so that the farewell comes after everything else."""
        self._copies = self.publisher(channels.copies(self.run, self.role, self.name))
        self._receive(channels.taken(self.run, self.role, self.name), self._take_taken)
        self._closing.callback(self.tap.close)
        if self._recorded:
            self.tap.start()

    def witness(self, role: Role) -> None:
        """Hand copies of what peers of this role say here to recorders, for those who do not do it themselves.

        Call it before subscribing to what they say.
        """
        self._witnessed.add(role)

    def _note_heard(self, header: Header, key: str, payload: bytes) -> None:
        """For recorders, if there are any."""
        if not self.tap.buffer.active:
            return
        tap = self._taps.get(header.incarnation)
        if tap is None:
            tap = self.stand_in(Origin(role=header.role, name=header.name, incarnation=header.incarnation))
            self._closing.callback(tap.close)
        tap.buffer.note(key, header.sequence, payload)

    def stand_in(self, origin: Origin) -> Tap:
        """A tap for another process, whose messages are published again; the caller closes it."""
        tap = Tap(TapBuffer(origin), self._send_copies)
        self._taps[origin.incarnation] = tap
        tap.start()
        tap.meet(self._recorders())
        return tap

    def _recorders(self) -> set[str]:
        return {peer.incarnation for peer in self.roster.live("recorder")}

    def _send_copies(self, build: Callable[[Header], Copies]) -> Copies:
        return self._copies.send(build)

    def _take_taken(self, taken: Taken) -> None:
        if (tap := self._taps.get(taken.origin_incarnation)) is not None:
            tap.take(taken.header.incarnation, taken.batch)

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
            for tap in tuple(self._taps.values()):
                tap.meet(self._recorders())
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
