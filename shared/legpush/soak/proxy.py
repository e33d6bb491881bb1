"""A link with a fault: a proxy on a unix socket that passes bytes on, and holds back, delays, harms or refuses them.

It knows nothing of the messages in the bytes. What is lost here is lost for the link, which then ends.
"""

import queue
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import Final, Literal

import numpy as np

CHUNK_BYTES: Final = 4096
LOOK_S: Final = 0.01
DELAY_S: Final = 0.2
SLOW_BYTES_PER_S: Final = 20_000
MAX_FLIPS: Final = 20
FLIP_PROBABILITY: Final = 0.5

LinkFault = Literal["", "cut", "stall", "delay", "slow_consumer", "corrupt"]
"""Empty: the link is sound."""


class LinkProxy:
    """Listens on `path` and passes every connection on to the socket that `target` names; close it at the end.

    `fault` may be set at any time. `cut` ends all connections and refuses new ones; `stall` holds all bytes back;
    `delay` adds 0.2 s each way; `slow_consumer` lets 20 kB/s through; `corrupt` flips bits.
    """

    def __init__(self, path: Path, target: Callable[[], Path], draw: np.random.Generator) -> None:
        self.n_flips = 0
        self._target = target
        self._draw = draw
        self._fault: LinkFault = ""
        self._connections: set[socket.socket] = set()
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(path))
        self._listener.listen()
        threading.Thread(target=self._accept, name="proxy", daemon=True).start()

    @property
    def fault(self) -> LinkFault:
        """What is wrong with the link at present."""
        return self._fault

    @fault.setter
    def fault(self, fault: LinkFault) -> None:
        self._fault = fault
        if fault == "cut":
            self._cut()

    def close(self) -> None:
        """End all connections, and listen no more."""
        self._over.set()
        _end(self._listener)
        self._cut()

    def _cut(self) -> None:
        with self._lock:
            ended, self._connections = self._connections, set()
        for connection in ended:
            _end(connection)

    def _accept(self) -> None:
        while not self._over.is_set():
            try:
                near, _ = self._listener.accept()
            except OSError:
                return
            far = socket.socket(socket.AF_UNIX)
            try:
                if self._fault == "cut":
                    raise ConnectionRefusedError
                far.connect(str(self._target()))
            except OSError:  # as if nobody listened
                near.close()
                far.close()
                continue
            with self._lock:
                self._connections |= {near, far}
            for source, sink in ((near, far), (far, near)):
                waiting: queue.Queue[tuple[float, bytes]] = queue.Queue(maxsize=16)
                for work in (self._take, self._give):
                    threading.Thread(target=work, args=(source, sink, waiting), name="proxy", daemon=True).start()

    def _take(self, source: socket.socket, sink: socket.socket, waiting: "queue.Queue[tuple[float, bytes]]") -> None:
        """Read what one side sends; an empty chunk is its end."""
        data = b"x"
        while data:
            try:
                data = source.recv(CHUNK_BYTES)
            except OSError:
                data = b""
            waiting.put((monotonic(), data))

    def _give(self, source: socket.socket, sink: socket.socket, waiting: "queue.Queue[tuple[float, bytes]]") -> None:
        """Pass it on to the other side."""
        data = b"x"
        with suppress(OSError):
            while data:
                came_s, data = waiting.get()
                self._hold(came_s, len(data))
                sink.sendall(self._harmed(data) if data else data)
        for end in (source, sink):
            _end(end)
        while data:  # so that the reading thread ends as well
            _, data = waiting.get()

    def _hold(self, came_s: float, n_bytes: int) -> None:
        """Wait for as long as the fault wants."""
        if self._fault == "slow_consumer":
            self._over.wait(n_bytes / SLOW_BYTES_PER_S)
        while self._fault == "delay" and (left_s := came_s + DELAY_S - monotonic()) > 0.0:
            self._over.wait(min(left_s, LOOK_S))
        while self._fault == "stall" and not self._over.is_set():
            self._over.wait(LOOK_S)

    def _harmed(self, data: bytes) -> bytes:
        """Return the bytes, some of them with a flipped bit if the fault is `corrupt`."""
        if self._fault != "corrupt" or self.n_flips >= MAX_FLIPS or self._draw.random() > FLIP_PROBABILITY:
            return data
        self.n_flips += 1
        harmed = bytearray(data)
        harmed[self._draw.integers(len(data))] ^= 1 << int(self._draw.integers(8))
        return bytes(harmed)


def _end(connection: socket.socket) -> None:
    """End a connection, and wake the threads that wait for it."""
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
    connection.close()
