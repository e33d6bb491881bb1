"""Where processes find each other: unix sockets in the run's directory, or fixed ports of this machine.

A process that is started alone listens on the port of its role on 127.0.0.1 and connects to its peers' ports, so that
planner, simulator and agent find each other without flags and in any order. The launcher gives them unix sockets in a
directory that only the user can enter.
"""

import re
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from legpush.errors import EndpointError
from legpush.messages.common import Role

PORTS: Final[dict[Role, int]] = {"planner": 17471, "sim": 17472, "agent": 17473}
CONNECTS_TO: Final[dict[Role, tuple[Role, ...]]] = {
    "planner": (),
    "sim": (),
    "agent": ("planner", "sim"),
    "launcher": ("planner", "sim", "agent"),
    "recorder": ("planner", "sim", "agent"),
}
PROTOCOLS: Final = ("unixsock-stream", "tcp")
_ADDRESS: Final = re.compile(r"[^?#]+:(?P<port>[0-9]{1,5})([?#]|\Z)")
"""A host and a port; Zenoh takes parameters behind them."""
MAX_PORT: Final = 65535
MAX_SOCKET_PATH_BYTES: Final = 107
"""`sun_path` holds 108 bytes with its final zero."""


@dataclass(frozen=True, kw_only=True)
class Endpoints:
    """Zenoh locators, such as `tcp/127.0.0.1:17472` or `unixsock-stream//run/user/0/legpush/sim.sock`."""

    listen: tuple[str, ...] = ()
    connect: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for locator in (*self.listen, *self.connect):
            _check(locator)


def local(role: Role) -> Endpoints:
    """The fixed ports on 127.0.0.1 of a process that is started alone."""
    return Endpoints(
        listen=(_tcp(role),) if role in PORTS else (),
        connect=tuple(_tcp(peer) for peer in CONNECTS_TO[role]),
    )


def in_directory(directory: Path, role: Role) -> Endpoints:
    """Return the unix sockets of a role in a run's directory.

    Raises:
        EndpointError: Other users may enter the directory, or its path is too long.
    """
    mode = stat.S_IMODE(directory.stat().st_mode)
    if mode & 0o077:
        raise EndpointError(f"Expected a directory with mode 0700 for the sockets, got {mode:04o} of {directory}")
    return Endpoints(
        listen=(_socket(directory, role),) if role in PORTS else (),
        connect=tuple(_socket(directory, peer) for peer in CONNECTS_TO[role]),
    )


def in_pool(directory: Path, name: str) -> Endpoints:
    """Endpoints of a simulator or planner of a pool: it listens for recorders, and connects to the agent."""
    return Endpoints(listen=(_socket(directory, name),), connect=in_directory(directory, "agent").listen)


def listing(locators: Sequence[str]) -> str:
    """For messages to people."""
    return ", ".join(locators) if locators else "nothing"


def _tcp(role: Role) -> str:
    return f"tcp/127.0.0.1:{PORTS[role]}"


def _socket(directory: Path, name: str) -> str:
    return f"unixsock-stream/{directory.absolute()}/{name}.sock"


def _check(locator: str) -> None:
    protocol, _, address = locator.partition("/")
    if protocol not in PROTOCOLS or not address:
        raise EndpointError(
            f"Expected an endpoint such as tcp/127.0.0.1:17472 (protocols: {', '.join(PROTOCOLS)}), got {locator!r}"
        )
    length = len(address.encode())
    if protocol == "unixsock-stream" and length > MAX_SOCKET_PATH_BYTES:
        raise EndpointError(
            f"Expected a unix socket path of at most {MAX_SOCKET_PATH_BYTES} bytes, got {length}: {address}; "
            "use a shorter path"
        )
    host_and_port = _ADDRESS.match(address)
    if protocol == "tcp" and (host_and_port is None or int(host_and_port["port"]) > MAX_PORT):
        raise EndpointError(
            f"Expected a host and a port from 0 to {MAX_PORT}, such as tcp/127.0.0.1:17472, got {locator!r}"
        )


DEFAULT_RUN: Final = "local"
DEFAULT_NAME: Final = "main"
