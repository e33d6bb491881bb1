"""All taps of a process: its own, and those in which it stands in for others."""

import threading
from typing import Final

from legpush.bus.tap_buffer import Send, TapBuffer
from legpush.bus.tap_sender import Tap
from legpush.messages.common import Header, Role
from legpush.messages.telemetry import Origin, Taken

MAX_HEARD: Final = 16
"""Incarnations that this process stands in for because it hears them; what later ones say is not handed over."""


class RecorderTaps:
    """Safe to use from any thread; `send` publishes a batch and returns it."""

    def __init__(self, own: Origin, send: Send) -> None:
        self._send = send
        self._lock = threading.Lock()
        self._hearing = threading.Lock()
        self._recorders: set[str] = set()
        self._witnessed: set[Role] = set()
        self._heard: dict[str, Tap] = {}
        self.own = Tap(TapBuffer(own), send)
        """Of what this process publishes."""
        self._taps = {own.incarnation: self.own}

    def set_recorders(self, recorders: set[str]) -> None:
        """These incarnations record now."""
        with self._lock:
            self._recorders = set(recorders)
            taps = tuple(self._taps.values())
        for tap in taps:
            tap.set_recorders(recorders)

    def acknowledge_batch(self, taken: Taken) -> None:
        """A recorder has a batch."""
        with self._lock:
            tap = self._taps.get(taken.origin_incarnation)
        if tap is not None:
            tap.acknowledge_batch(taken.header.incarnation, taken.batch)

    def stand_in_for(self, origin: Origin) -> Tap:
        """A tap for another process, whose messages are published again; the caller closes it."""
        tap = Tap(TapBuffer(origin), self._send)
        with self._lock:
            self._taps[origin.incarnation] = tap
            recorders = set(self._recorders)
        tap.start()
        tap.set_recorders(recorders)
        return tap

    def close_stand_in(self, tap: Tap) -> None:
        """Close a tap that stood in for another process, and forget it."""
        tap.close()
        with self._lock:
            self._taps = {incarnation: each for incarnation, each in self._taps.items() if each is not tap}

    def witness_role(self, role: Role) -> None:
        """Hand over what peers of this role say here, too, for those who do not do it themselves.

        Call it before subscribing to what they say.
        """
        self._witnessed.add(role)

    def note_message(self, header: Header, key: str, payload: bytes) -> None:
        """A message came; it is noted if its sender is witnessed and somebody records."""
        if header.role not in self._witnessed or not self.own.buffer.active:
            return
        with self._hearing:
            tap = self._heard.get(header.incarnation)
            if tap is None:
                if len(self._heard) >= MAX_HEARD:
                    return
                tap = self.stand_in_for(Origin(role=header.role, name=header.name, incarnation=header.incarnation))
                self._heard[header.incarnation] = tap
        tap.buffer.note_message(key, header.sequence, payload)

    def close(self) -> None:
        """Say farewell to those who record."""
        for tap in self._heard.values():
            tap.close()
        self.own.close()
