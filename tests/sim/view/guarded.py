"""A guarded server with a scene, and raw clients of it."""

import socket
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import viser
from websockets.sync.client import ClientConnection, connect

from sim_proc.view.guard import cookie_name, start_server

COLOR = (7, 77, 177)
N_POINTS = 300
SCENE = bytes(COLOR) * N_POINTS
"""Bytes that everybody gets who is shown the scene."""
SUBPROTOCOL = f"viser-v{viser.__version__}"
UPGRADE = (
    "Connection: Upgrade",
    "Upgrade: websocket",
    "Sec-WebSocket-Version: 13",
    "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
    f"Sec-WebSocket-Protocol: {SUBPROTOCOL}",
)
PATIENCE_S = 10.0
OWN_HOST = "Host: 127.0.0.1:{port}"


@dataclass(frozen=True)
class Served:
    """A server with a scene behind a guard."""

    server: viser.ViserServer
    token: str

    @property
    def port(self) -> int:
        return self.server.get_port()

    @property
    def cookie(self) -> str:
        return f"{cookie_name(self.port)}={self.token}"

    def fill(self, text: str) -> str:
        """Put port, token and cookie into a text."""
        return text.format(port=self.port, token=self.token, cookie=self.cookie)


def serve(host: str) -> Served:
    served = Served(*start_server(host, 0))
    colors = np.full((N_POINTS, 3), COLOR, dtype=np.uint8)
    served.server.scene.add_point_cloud("points", np.zeros((N_POINTS, 3), np.float32), colors)
    return served


def answer(port: int, sent: bytes, host: str = "127.0.0.1") -> bytes:
    """Everything that the server says to these bytes before it closes."""
    with socket.create_connection((host, port), timeout=PATIENCE_S) as client:
        client.sendall(sent)
        said = b""
        while part := client.recv(65536):
            said += part
    return said


def request(target: str, *headers: str) -> bytes:
    return "\r\n".join((f"GET {target} HTTP/1.1", *headers, "", "")).encode()


def is_refused(said: bytes, sentence: str) -> bool:
    """Whether the answer is 403 with the sentence and no byte more."""
    head, _, body = said.partition(b"\r\n\r\n")
    return head.startswith(b"HTTP/1.1 403 Forbidden\r\n") and body.decode() == sentence and b"Cookie" not in head


def client(served: Served, query: str = "", **headers: str) -> ClientConnection:
    return connect(
        f"ws://127.0.0.1:{served.port}/{query}",
        subprotocols=[cast(Any, SUBPROTOCOL)],
        additional_headers=headers,
        max_size=None,
        proxy=None,
        compression=None,
    )
