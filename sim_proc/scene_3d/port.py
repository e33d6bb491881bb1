"""The port at which a page is served."""

import socket

from legpush.errors import ConfigError


def free_port(host: str, port: int = 0) -> int:
    """The port, or any free one if it is 0.

    Raises:
        ConfigError: The address cannot be listened on.
    """
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((host, port))
            return int(probe.getsockname()[1])
    except OSError as error:
        raise ConfigError(
            f"Expected an address to listen on for --host and --port, got {host}:{port} ({error.strerror}); "
            "--port 0 takes any free port"
        ) from error
