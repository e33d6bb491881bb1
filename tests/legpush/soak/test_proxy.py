"""Proxies on links: sound ones change nothing, and each fault does what its name says."""

import socket
import threading
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from legpush.soak.proxy import DELAY_S, MAX_FLIPS, LinkFault, LinkProxy
from tests.legpush.fakes import eventually

DATA = bytes(range(256)) * 400


class Echo:
    """A server that sends back what it gets."""

    def __init__(self, path: Path) -> None:
        self.n_connections = 0
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(path))
        self._listener.listen()
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            connection, _ = self._listener.accept()
            self.n_connections += 1
            threading.Thread(target=self._echo, args=(connection,), daemon=True).start()

    def _echo(self, connection: socket.socket) -> None:
        with suppress(OSError):
            while data := connection.recv(65536):
                connection.sendall(data)
        connection.close()


@pytest.fixture
def link(tmp_path: Path) -> Iterator[tuple[LinkProxy, Path, Echo]]:
    """A proxy before a server, and where it listens."""
    echo, path = Echo(tmp_path / "server"), tmp_path / "proxy"
    with closing(LinkProxy(path, lambda: tmp_path / "server", np.random.default_rng(1))) as proxy:
        yield proxy, path, echo


def connected(path: Path) -> socket.socket:
    client = socket.socket(socket.AF_UNIX)
    client.settimeout(10.0)
    client.connect(str(path))
    return client


def exchange(client: socket.socket, data: bytes) -> bytes:
    """What comes back; less if the link ends."""

    def send() -> None:
        with suppress(OSError):
            client.sendall(data)

    threading.Thread(target=send, daemon=True).start()
    got = b""
    while len(got) < len(data) and (part := client.recv(65536)):
        got += part
    return got


def test_a_sound_link_passes_every_byte_on(link: tuple[LinkProxy, Path, Echo]) -> None:
    with connected(link[1]) as client:
        assert exchange(client, DATA) == DATA


def test_a_link_that_is_cut_ends_and_is_refused_until_it_is_sound_again(link: tuple[LinkProxy, Path, Echo]) -> None:
    proxy, path, echo = link
    with connected(path) as client:
        assert exchange(client, b"x") == b"x"
        proxy.fault = "cut"
        assert client.recv(1) == b""
    with connected(path) as client, suppress(OSError):
        assert exchange(client, b"x") == b""
    assert echo.n_connections == 1
    proxy.fault = ""
    with connected(path) as client:
        assert exchange(client, DATA) == DATA


def test_a_link_that_stalls_loses_nothing(link: tuple[LinkProxy, Path, Echo]) -> None:
    proxy, path, _ = link
    with connected(path) as client:
        proxy.fault = "stall"
        client.sendall(b"held")
        client.settimeout(0.2)
        with pytest.raises(TimeoutError):
            client.recv(4)
        proxy.fault = ""
        client.settimeout(10.0)
        assert client.recv(4) == b"held"


@pytest.mark.parametrize(("fault", "least_s"), [("delay", 2 * DELAY_S), ("slow_consumer", 0.2)])
def test_a_slow_link_loses_nothing(link: tuple[LinkProxy, Path, Echo], fault: LinkFault, least_s: float) -> None:
    proxy, path, _ = link
    with connected(path) as client:
        proxy.fault = fault
        began_s = monotonic()
        assert exchange(client, DATA[:3000]) == DATA[:3000]
        assert monotonic() - began_s >= least_s


def test_a_corrupt_link_flips_single_bits_and_no_more_than_some(link: tuple[LinkProxy, Path, Echo]) -> None:
    proxy, path, _ = link
    with connected(path) as client:
        proxy.fault = "corrupt"
        n_bits = 0
        for _ in range(60):
            got = exchange(client, DATA[:4000])
            assert len(got) == 4000
            n_bits += sum((one ^ other).bit_count() for one, other in zip(got, DATA[:4000], strict=True))
    assert 0 < n_bits <= proxy.n_flips == MAX_FLIPS


def test_nothing_listens_behind_it_is_as_if_nobody_listened(tmp_path: Path) -> None:
    path = tmp_path / "proxy"
    with (
        closing(LinkProxy(path, lambda: tmp_path / "nobody", np.random.default_rng(1))),
        connected(path) as client,
        suppress(OSError),
    ):
        assert client.recv(1) == b""


def test_no_thread_is_left_when_it_is_closed(tmp_path: Path) -> None:
    Echo(tmp_path / "server")
    before = {thread for thread in threading.enumerate() if thread.name == "proxy"}
    path = tmp_path / "proxy"
    with (
        closing(LinkProxy(path, lambda: tmp_path / "server", np.random.default_rng(1))),
        connected(path) as client,
    ):
        assert exchange(client, b"x") == b"x"
    assert eventually(lambda: {thread for thread in threading.enumerate() if thread.name == "proxy"} <= before)
