"""Where processes find each other: unix sockets in the run's directory, or in one of the user's own.

A process that is started alone listens on the socket of its role in a directory of the user, and connects to its peers'
sockets there, so that planner, simulator and agent find each other without flags and in any order. The launcher gives
them sockets in a directory of the run. No other user can enter either of them. TCP is for those who ask for it, and TLS
for those who have credentials: then nothing else is used.
"""

import os
import re
import socket
import stat
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from legpush.bus.secure.host_folder import Credentials
from legpush.errors import EndpointError
from legpush.messages.common import Role

LISTENING: Final[tuple[Role, ...]] = ("planner", "sim", "agent")
"""Roles that others connect to."""
CONNECTS_TO: Final[dict[Role, tuple[Role, ...]]] = {
    "planner": (),
    "sim": (),
    "agent": ("planner", "sim"),
    "worker": ("agent",),
    "launcher": LISTENING,
    "recorder": LISTENING,
}
PROTOCOLS: Final = ("unixsock-stream", "tcp", "tls")
TLS_PORTS: Final[dict[Role, int]] = {"planner": 17471, "sim": 17472, "agent": 17473}
"""Where a process with credentials listens on 127.0.0.1 if nothing else is asked for."""
_ADDRESS: Final = re.compile(r"[^?#]+:(?P<port>[0-9]{1,5})([?#]|\Z)")
"""A host and a port; Zenoh takes parameters behind them."""
ROUTER_PORT: Final = 17470
"""The same, for a router."""
Mode = Literal["peer", "client", "router"]
"""A peer is linked directly with others, a client with one router, and a router with routers and clients."""
MAX_PORT: Final = 65535
MAX_SOCKET_PATH_BYTES: Final = 107
"""`sun_path` holds 108 bytes with its final zero."""


@dataclass(frozen=True, kw_only=True)
class Endpoints:
    """Zenoh locators, such as `tcp/127.0.0.1:17472` or `unixsock-stream//run/user/0/legpush/sim.sock`."""

    listen: tuple[str, ...] = ()
    connect: tuple[str, ...] = ()
    credentials: Credentials | None = None
    """With which certificate this process talks over TLS, and with which others."""
    mode: Mode = "peer"

    def __post_init__(self) -> None:
        for locator in (*self.listen, *self.connect):
            require_locator(locator)
            if locator.startswith("tls/") is (self.credentials is None):
                raise EndpointError(
                    f"Expected --secure DIR with {locator}, got no certificate"
                    if self.credentials is None
                    else f"Expected endpoints such as tls/127.0.0.1:17472 with --secure, got {locator!r}"
                )


def own_directory() -> Path:
    """The directory of the sockets of processes that this user starts alone.

    It depends on the user alone, not on the environment, so that all terminals and services of a user have the same.
    """
    return Path(f"/tmp/legpush.{os.getuid()}")  # noqa: S108 - `prepare` sees to it that nobody else can enter it


def local(role: Role, credentials: Credentials | None = None) -> Endpoints:
    """The unix sockets of a process that is started alone; `prepare` makes their directory.

    With credentials, TLS ports of 127.0.0.1 instead.
    """
    if credentials is None:
        return _sockets(own_directory(), role)
    return on_loopback(role, TLS_PORTS, credentials)


def of_router(credentials: Credentials | None = None) -> str:
    """The unix socket of a router that is started alone; with credentials, a TLS port of 127.0.0.1 instead."""
    return _socket(own_directory(), "router") if credentials is None else f"tls/127.0.0.1:{ROUTER_PORT}"


def by_router(routers: Sequence[str], credentials: Credentials | None = None) -> Endpoints:
    """Endpoints of a client of routers: of the first one that answers, and of another one when that is gone."""
    return Endpoints(connect=tuple(routers), credentials=credentials, mode="client")


def require_alone(routers: Sequence[str], others: Sequence[str]) -> None:
    """Check that a client of routers neither listens nor connects elsewhere.

    Raises:
        EndpointError: It does.
    """
    if routers and others:
        raise EndpointError(
            f"Expected either --router or --listen and --connect, got --router {' '.join(routers)} and "
            f"{listing(others)}: a client of a router is linked with nothing else"
        )


def on_loopback(role: Role, ports: Mapping[Role, int], credentials: Credentials) -> Endpoints:
    """TLS ports of 127.0.0.1 for a role, of those that planner, simulator and agent listen on."""
    at = {peer: f"tls/127.0.0.1:{port}" for peer, port in ports.items()}
    return Endpoints(
        listen=(at[role],) if role in LISTENING else (),
        connect=tuple(at[peer] for peer in CONNECTS_TO[role]),
        credentials=credentials,
    )


def prepare(endpoints: Endpoints) -> None:
    """Make the directory of the user, if one of the sockets is in it, and require that nobody else can enter it.

    Raises:
        EndpointError: Another user has made it, others may enter it, or it cannot be made.
    """
    directory = own_directory()
    if not any(
        locator.startswith(f"{PROTOCOLS[0]}/{directory}/") for locator in (*endpoints.listen, *endpoints.connect)
    ):
        return
    try:
        directory.mkdir(mode=0o700, exist_ok=True)
        found = directory.lstat()
    except OSError as error:
        raise EndpointError(f"Expected to make {directory} for sockets, but {error.strerror}") from error
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid():
        raise EndpointError(f"Expected {directory} to be a directory of this user, got one of user {found.st_uid}")
    _require_private(directory)


def free_ports(roles: Sequence[Role]) -> dict[Role, int]:
    """Return a different port of 127.0.0.1 for each role, on which nobody listens now."""
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in roles]
        return {role: one.getsockname()[1] for role, one in zip(roles, sockets, strict=True)}


def in_directory(directory: Path, role: Role) -> Endpoints:
    """Return the unix sockets of a role in a run's directory.

    Raises:
        EndpointError: Other users may enter the directory, or its path is too long.
    """
    _require_private(directory)
    return _sockets(directory, role)


def in_pool(directory: Path, name: str) -> Endpoints:
    """Endpoints of a simulator or planner of a pool: it listens for recorders, and connects to the agent."""
    return Endpoints(listen=(_socket(directory, name),), connect=in_directory(directory, "agent").listen)


def listing(locators: Sequence[str]) -> str:
    """For messages to people."""
    return ", ".join(locators) if locators else "nothing"


def _require_private(directory: Path) -> None:
    mode = stat.S_IMODE(directory.stat().st_mode)
    if mode & 0o077:
        raise EndpointError(f"Expected a directory with mode 0700 for the sockets, got {mode:04o} of {directory}")


def _sockets(directory: Path, role: Role) -> Endpoints:
    return Endpoints(
        listen=(_socket(directory, role),) if role in LISTENING else (),
        connect=tuple(_socket(directory, peer) for peer in CONNECTS_TO[role]),
    )


def _socket(directory: Path, name: str) -> str:
    return f"unixsock-stream/{directory.absolute()}/{name}.sock"


def require_locator(locator: str) -> None:
    """Check the form of an endpoint.

    Raises:
        EndpointError: It has another form; says which.
    """
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
    if protocol in ("tcp", "tls") and (host_and_port is None or int(host_and_port["port"]) > MAX_PORT):
        raise EndpointError(
            f"Expected a host and a port from 0 to {MAX_PORT}, such as {protocol}/127.0.0.1:17472, got {locator!r}"
        )


DEFAULT_RUN: Final = "local"
DEFAULT_NAME: Final = "main"
