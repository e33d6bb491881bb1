"""A TCP link between two distant machines: a proxy with delay, rate and loss, and what a model of it predicts.

`python -m benchmarks.bus.slow_link FROM_PORT TO_PORT` passes the bytes of every connection on in packets. A packet
takes its time at the rate, then the delay. TCP hides that a packet was lost: it arrives one retransmission later, and
all that follow wait for it. That is so for the last packets of a message, with which a lockstep has to do; within long
messages TCP repeats a packet sooner, so the loss of the proxy is the worse one.
"""

import queue
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from time import monotonic, sleep
from typing import Any, Final

import numpy as np
import tyro

PACKET_BYTES: Final = 1448
"""Payload of a TCP packet with time stamps on Ethernet."""
LEAST_RETRANSMISSION_S: Final = 0.2
"""Linux waits this long, and one round trip, before it repeats the last packet."""
LOOPBACK: Final = "127.0.0.1"


@dataclass(frozen=True, kw_only=True)
class Link:
    """A link, the same in both directions."""

    delay_ms: float = 0.0
    """One way."""
    loss: float = 0.0
    """Share of the packets."""
    mbit_s: float = 0.0
    """Rate; 0 for no limit."""

    @property
    def retransmission_s(self) -> float:
        """How much later a packet arrives that was lost once."""
        return LEAST_RETRANSMISSION_S + 2e-3 * self.delay_ms

    def sending_s(self, n_bytes: int) -> float:
        """How long bytes take at the rate."""
        return 8e-6 * n_bytes / self.mbit_s if self.mbit_s else 0.0

    def message_s(self, n_bytes: int) -> float:
        """Return how long a message is expected to take from its first byte sent to its last byte received.

        If packet i is the last one that is lost, all that follow have to wait for it, unless they come later anyway.
        """
        n = -(-n_bytes // PACKET_BYTES)
        packet_s = self.sending_s(PACKET_BYTES)
        behind = np.arange(n)
        stalls_s = np.maximum(0.0, self.retransmission_s - behind * packet_s)
        stall_s = float(np.sum(self.loss * (1.0 - self.loss) ** behind * stalls_s))
        return self.sending_s(n_bytes) + 1e-3 * self.delay_ms + stall_s


class SlowLink:
    """Listens on a port of 127.0.0.1, and passes every connection on to another port over a link."""

    def __init__(self, link: Link, from_port: int, to_port: int, seed: int = 0) -> None:
        self._link, self._to_port = link, to_port
        self._seeds = np.random.SeedSequence(seed)
        self._listener = socket.create_server((LOOPBACK, from_port))
        _thread(self._accept)

    def close(self) -> None:
        """Listen no more."""
        self._listener.close()

    def _accept(self) -> None:
        while True:
            try:
                near, _ = self._listener.accept()
                far = socket.create_connection((LOOPBACK, self._to_port))
            except ConnectionRefusedError:
                near.close()
                continue
            except OSError:
                return
            for one, other, seed in zip((near, far), (far, near), self._seeds.spawn(2), strict=True):
                one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                way = _Way(self._link, one, other, np.random.default_rng(seed))
                _thread(way.read)
                _thread(way.write)


class _Way:
    """One direction of a connection."""

    def __init__(self, link: Link, source: socket.socket, target: socket.socket, draw: np.random.Generator) -> None:
        self._link, self._source, self._target, self._draw = link, source, target, draw
        self._on_the_way: queue.SimpleQueue[tuple[float, bytes]] = queue.SimpleQueue()

    def read(self) -> None:
        """Say of each packet when it arrives."""
        free_s = arrived_s = 0.0
        while True:
            try:
                chunk = self._source.recv(1 << 16)
            except OSError:
                chunk = b""
            now = monotonic()
            n_bytes = PACKET_BYTES if self._link.mbit_s or self._link.loss else 1 << 16
            for start in range(0, len(chunk), n_bytes):
                packet = chunk[start : start + n_bytes]
                free_s = max(now, free_s) + self._link.sending_s(len(packet))
                stall_s = self._link.retransmission_s if self._draw.random() < self._link.loss else 0.0
                arrived_s = max(arrived_s, free_s + 1e-3 * self._link.delay_ms + stall_s)
                self._on_the_way.put((arrived_s, packet))
            if not chunk:
                self._on_the_way.put((arrived_s, b""))
                return

    def write(self) -> None:
        """Hand packets over as they arrive; an empty one is the end of the connection."""
        while True:
            arrives_s, packet = self._on_the_way.get()
            sleep(max(0.0, arrives_s - monotonic()))
            with suppress(OSError):
                if not packet:
                    self._target.shutdown(socket.SHUT_WR)
                    return
                self._target.sendall(packet)


def _thread(work: Callable[[], Any]) -> None:
    threading.Thread(target=work, daemon=True).start()


def main(from_port: tyro.conf.Positional[int], to_port: tyro.conf.Positional[int], link: Link, seed: int = 0) -> None:
    """Be a link until this process is killed."""
    slow = SlowLink(link, from_port, to_port, seed)
    print("linked", flush=True)
    threading.Event().wait()
    slow.close()


if __name__ == "__main__":
    tyro.cli(main)
