"""Ports for tests that need to know them before something listens there."""

import socket
from contextlib import ExitStack


def free_ports(n_ports: int) -> list[int]:
    """Different ports of 127.0.0.1 that nobody listens on."""
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in range(n_ports)]
        return [listener.getsockname()[1] for listener in sockets]
