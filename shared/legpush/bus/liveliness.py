"""Who is there: the incarnations of every peer, whether they live, and when each was last heard."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic
from typing import Final

from legpush.messages.common import PROTOCOL_VERSION, Role
from legpush.messages.telemetry import Status

LEASE_S: Final = 2.0
"""A link on which nothing came for this long is given up."""
KEEP_GONE: Final = 16
"""How many incarnations that are gone are remembered, for error messages."""
MOST_OTHERS: Final = 64
"""How many processes that speak another protocol are remembered, for error messages."""


@dataclass
class Sighting:
    """What is known of one incarnation."""

    role: Role
    name: str
    incarnation: str
    alive: bool = False
    n_links: int = 0
    """How often its token came up: each time, what was under way before may be lost."""
    heard_at: float | None = None
    """Monotonic time of its last message."""
    gone_at: float | None = None
    doing: str = ""
    """What it last said it was doing."""
    numerics: str | None = None
    """With which numerics it said that it computes; None before its first status."""


class Liveliness:
    """Kept by the bus from liveliness tokens and messages; safe to read from any thread."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._sightings: dict[tuple[Role, str, str], Sighting] = {}
        self._of_peer: dict[tuple[Role, str], dict[str, Sighting]] = {}
        """The same by role and name, then by incarnation, as who waits for one peer among many looks for it often."""
        self._other_versions: dict[tuple[Role, str, str], int] = {}
        """Protocols of processes that speak another one."""

    def note_token(self, role: Role, name: str, incarnation: str, alive: bool) -> None:
        """Note that a liveliness token came up or went down."""
        with self._lock:
            sighting = self._sighting(role, name, incarnation)
            sighting.alive = alive
            sighting.n_links += alive
            sighting.gone_at = None if alive else self._clock()

    def note_message(self, role: Role, name: str, incarnation: str) -> None:
        """Note that a valid message of this sender came in."""
        with self._lock:
            self._sighting(role, name, incarnation).heard_at = self._clock()

    def note_status(self, status: Status) -> None:
        """Note what a process says of itself."""
        with self._lock:
            header = status.header
            sighting = self._sighting(header.role, header.name, header.incarnation)
            sighting.doing, sighting.numerics = status.phase, status.numerics

    def note_other_version(self, role: Role, name: str, incarnation: str, protocol: int, alive: bool) -> None:
        """Note that a process came or went that speaks another protocol, so that nobody here can talk to it."""
        with self._lock:
            if not alive:
                self._other_versions.pop((role, name, incarnation), None)
            elif len(self._other_versions) < MOST_OTHERS:
                self._other_versions[role, name, incarnation] = protocol

    def other_versions(self, role: Role, name: str | None = None) -> dict[str, int]:
        """Return the protocols that live processes speak to which nobody here can talk, by their names."""
        with self._lock:
            return self._of_other_versions(role, name)

    def live(self, role: Role | None = None, name: str | None = None) -> list[Sighting]:
        """Those that are alive, of this role and name if given; copies, in the order in which they were first seen."""
        with self._lock:
            return [Sighting(**vars(s)) for s in self._matching(role, name) if s.alive]

    def is_live(self, role: Role, name: str, incarnation: str) -> bool:
        """Return whether this incarnation shows a liveliness token with this role and name."""
        with self._lock:
            sighting = self._sightings.get((role, name, incarnation))
            return sighting is not None and sighting.alive

    def __len__(self) -> int:
        with self._lock:
            return len(self._sightings)

    def describe(self, role: Role, name: str | None = None) -> str:
        """One clause on the state of this peer: not there, several, dead, frozen or slow, and its last message."""
        with self._lock:
            matching = self._matching(role, name)
            living = [s for s in matching if s.alive]
            if len(living) > 1:
                return f"several processes, {len(living)} of them ({', '.join(sorted(s.incarnation for s in living))})"
            if living:
                said = f', it says "{living[0].doing}"' if living[0].doing else ""
                return f"slow: it is alive, {self._last_heard(living[0])}{said}"
            for protocol in self._of_other_versions(role, name).values():
                return f"of another version: it speaks protocol {protocol}, expected {PROTOCOL_VERSION}"
            if not matching:
                return "not there: it has not been seen yet"
            return self._describe_gone(matching[-1])

    def _describe_gone(self, sighting: Sighting) -> str:
        """If the peer was talking until the link closed, it died. If it had gone silent, the link timed out."""
        if sighting.gone_at is None:
            return f"not there: {self._last_heard(sighting)}, but it announced no liveliness token"
        last = sighting.heard_at
        silent_s = LEASE_S if last is None else sighting.gone_at - last
        word = "frozen or cut off: its link timed out" if silent_s > 0.8 * LEASE_S else "dead: its link closed"
        return f"{word} {self._clock() - sighting.gone_at:.1f} s ago, {self._last_heard(sighting)}"

    def _last_heard(self, sighting: Sighting) -> str:
        if sighting.heard_at is None:
            return "no message from it yet"
        return f"last heard {self._clock() - sighting.heard_at:.1f} s ago"

    def _matching(self, role: Role | None, name: str | None) -> list[Sighting]:
        if role is not None and name is not None:
            return list(self._of_peer.get((role, name), {}).values())
        return [s for s in self._sightings.values() if role in (None, s.role) and name in (None, s.name)]

    def _of_other_versions(self, role: Role, name: str | None) -> dict[str, int]:
        found = self._other_versions.items()
        return {own: protocol for (of, own, _), protocol in found if of == role and name in (None, own)}

    def _sighting(self, role: Role, name: str, incarnation: str) -> Sighting:
        """The entry of this incarnation, newly made and old ones forgotten where needed.

        Role and name belong to the key: a token of another role must not change what is known of this process.
        """
        key = (role, name, incarnation)
        known = self._sightings.get(key)
        if known is None:
            gone = [old for old, sighting in self._sightings.items() if not sighting.alive]
            for old in gone[: max(0, len(gone) - KEEP_GONE + 1)]:
                self._forget(old)
            known = self._sightings[key] = Sighting(role, name, incarnation)
            self._of_peer.setdefault((role, name), {})[incarnation] = known
        return known

    def _forget(self, key: tuple[Role, str, str]) -> None:
        role, name, incarnation = key
        del self._sightings[key], self._of_peer[role, name][incarnation]
        if not self._of_peer[role, name]:
            del self._of_peer[role, name]
