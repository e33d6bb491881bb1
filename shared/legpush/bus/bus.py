"""The bus: typed publishers and subscriptions over a network session, and which peers are there."""

import logging
import secrets
import threading
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from types import TracebackType
from typing import Self

from legpush.bus import channels, keys
from legpush.bus.channels import Channel, M
from legpush.bus.endpoints import Endpoints, listing
from legpush.bus.faults import BadChannel, Faults, fate_table
from legpush.bus.keys import parse_token
from legpush.bus.liveliness import Liveliness
from legpush.bus.ports import Publisher, Subscription
from legpush.bus.recorder_taps import RecorderTaps
from legpush.bus.secure.host_folder import Credentials
from legpush.bus.session import ZenohSession
from legpush.bus.tally import Tally
from legpush.bus.transport import Session
from legpush.bus.validation import Validation
from legpush.errors import MessageError
from legpush.messages.common import PROTOCOL_VERSION, Header, Role
from legpush.messages.telemetry import Copies, Fact, Origin, Status

log = logging.getLogger(__name__)

OnPeer = Callable[[Role, str, str, bool], None]
"""Role, name, incarnation, alive; called on a thread of the bus."""


class Bus:
    """One process on the bus; a context manager that connects on entry and always closes.

    `liveliness` knows which peers are there, `tally` counts the messages that were refused or dropped, by cause, and
    `taps` hold copies of what is published, for recorders.
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
        stop: threading.Event | None = None,
        open_session: Callable[[Endpoints, str], Session] | None = None,
        incarnation: str | None = None,
        watches_links: bool = True,
    ) -> None:
        """With `recorded`, a later recorder gets everything from now on; `open_session` opens the network.

        `stop` ends waiting for a router, by a `StopRequestedError`. An `incarnation` has to be a new one; without it,
        the bus makes one. Of several buses that share a session, one is enough that `watches_links`, to tell about
        certificates.
        """
        self.run = run
        self.role = role
        self.name = name
        self.endpoints = endpoints
        self.incarnation = incarnation or secrets.token_hex(6)
        self.liveliness = Liveliness()
        self.tally = Tally()
        self._faults = faults if faults is not None and faults.probability > 0.0 else None
        self._on_peer: list[OnPeer] = []
        self._followed: set[tuple[Role, str | None]] = set()
        self._closing = ExitStack()
        self._recorded = recorded
        self._watches_links = watches_links
        self._open_session = open_session or partial(ZenohSession, stop=stop)
        origin = Origin(role=role, name=name, incarnation=self.incarnation)
        self.taps = RecorderTaps(origin, self._send_copies)

    def __enter__(self) -> Self:
        self._session = self._open_session(self.endpoints, f"{self.role} {self.name}")
        self._closing.callback(self._session.close)
        log.info(
            "run %s, incarnation %s, listening on %s, connecting to %s",
            self.run,
            self.incarnation,
            listing(self.endpoints.listen),
            listing(self.endpoints.connect),
        )
        self._open_taps()
        everybody = keys.liveliness_of_any_version(self.run, "*", "*", "*")
        self._closing.callback(self._session.watch_tokens(everybody, self._take_token))
        if self.endpoints.credentials is not None and self._watches_links:
            self._watch_links(self.endpoints.credentials)
        return self

    def _watch_links(self, credentials: Credentials) -> None:
        from legpush.bus.secure.link_watch import LinkWatch

        log.info("taking part as %s", credentials.name)
        watch = LinkWatch(credentials, self.endpoints.connect, self._session.linked, self._roles_shown)
        self._closing.enter_context(watch)

    def _roles_shown(self) -> set[str]:
        """Roles of which a live process shows its token."""
        return {peer.role for peer in self.liveliness.live()}

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._closing.close()

    def publisher(self, channel: Channel[M]) -> Publisher[M]:
        """What sends on `channel`; lockstep channels go through the injected faults, if there are any."""
        sender = self._session.publisher(channel.key, channel.quality)
        self._closing.callback(sender.undeclare)
        note = partial(self.taps.own.buffer.note_message, channel.key) if channel.is_copied else None
        if channel.quality != "lockstep" or self._faults is None:
            return Publisher(self._header, sender.send, note)
        bad_channel = BadChannel(fate_table(self._faults, channel.key), sender.send)
        self._closing.callback(bad_channel.close)
        return Publisher(self._header, bad_channel.send, note)

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Hand this file to recorders as well."""
        self.taps.own.buffer.attach(Fact(name=name, media_type=media_type, data=data))

    def put(self, key: str, payload: bytes) -> None:
        """Publish bytes as they are, valid or not."""
        self._session.put(key, payload)

    def subscribe(self, channel: Channel[M], into: Subscription[M] | None = None) -> Subscription[M]:
        """Subscribe to the messages of `channel`; those that are not valid are counted in `tally` and logged."""
        subscription = into or Subscription(channel, self.tally)
        self._receive(channel, subscription.put)
        return subscription

    def follow(self, role: Role, name: str | None = None) -> None:
        """Keep `liveliness` up to date on the status of these peers, their heartbeat, from now on."""
        if not self._followed & {(role, None), (role, name)}:
            self._followed.add((role, name))
            self._receive(channels.statuses(self.run, role, name or "*"), lambda _: None)

    def _receive(self, channel: Channel[M], put: Callable[[M], None]) -> None:
        validation = Validation(channel, self.run, self.tally)

        def take_payload(key: str, payload: bytes) -> None:
            message = validation.validate_payload(key, payload)
            if message is not None:
                header = message.header
                if channel.is_copied:
                    self.taps.note_message(header, key, payload)
                self.liveliness.note_message(header.role, header.name, header.incarnation)
                if isinstance(message, Status):
                    self.liveliness.note_status(message)
                put(message)

        def refuse_damaged(key: str) -> None:
            self.tally.add("damaged", f"{key}: expected the bytes that were sent, got others by the checksum")

        self._closing.callback(self._session.subscribe(channel.key, take_payload, refuse_damaged))

    def announce(self) -> None:
        """Show the liveliness token: this process is ready. Call it after subscribing, once."""
        own = keys.liveliness(self.run, self.role, self.name, self.incarnation)
        self._closing.callback(self._session.show_token(own))

    def watch(self, on_peer: OnPeer) -> None:
        """Call `on_peer` whenever a peer's liveliness token comes or goes, and now for those already there."""
        self._on_peer.append(on_peer)
        for peer in self.liveliness.live():
            on_peer(peer.role, peer.name, peer.incarnation, True)

    def _open_taps(self) -> None:
        """Declared before anything is published, so that the farewell comes after everything else."""
        self._copies = self.publisher(channels.copies(self.run, self.role, self.name))
        self._receive(channels.taken(self.run, self.role, self.name), self.taps.acknowledge_batch)
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

    def _take_token(self, key: str, alive: bool) -> None:
        """Note a liveliness token that came or went, and tell those who watch."""
        try:
            token = parse_token(key)
        except MessageError as error:
            self.tally.add(error.cause, f"{key}: {error}")
            return
        if token.incarnation == self.incarnation:
            return
        if token.protocol != PROTOCOL_VERSION:
            self.liveliness.note_other_version(token.role, token.name, token.incarnation, token.protocol, alive)
            if alive:
                other = f"{token.role}/{token.name} speaks protocol {token.protocol}"
                self.tally.add("version", f"{other}, this process {PROTOCOL_VERSION}")
            return
        self.liveliness.note_token(token.role, token.name, token.incarnation, alive)
        if token.role == "recorder" and self.role != "recorder":
            self.taps.set_recorders({peer.incarnation for peer in self.liveliness.live("recorder")})
        for on_peer in self._on_peer:
            on_peer(token.role, token.name, token.incarnation, alive)
