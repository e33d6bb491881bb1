"""Checks that a Ray cluster asks for its token, before Ray is loaded and before anything is sent to it."""

import os
from pathlib import Path
from typing import Final, Literal

import grpc

from legpush.errors import ConfigError

Server = Literal["head", "client server"]
"""What listens at an address: a head for nodes of its cluster, or its client server for other machines (`ray://`)."""

METHODS: Final[dict[Server, str]] = {
    "head": "/ray.rpc.NodeInfoGcsService/GetAllNodeInfo",
    "client server": "/ray.rpc.RayletDriver/ClusterInfo",
}
"""A harmless question that each server looks at only if its token is given; an empty request is a valid one."""
TIMEOUT_S: Final = 10.0
N_BYTES_MAX: Final = 64 * 2**20
DEFAULT_FILE: Final = Path(".ray", "auth_token")
"""Where Ray keeps its token, in the home directory."""


def read_token() -> str:
    """Return the token that Ray would use: `RAY_AUTH_TOKEN`, the file at `RAY_AUTH_TOKEN_PATH`, or `~/.ray/auth_token`.

    Raises:
        ConfigError: There is none, or its file cannot be read.
    """
    if token := os.environ.get("RAY_AUTH_TOKEN", "").strip():
        return token
    named = os.environ.get("RAY_AUTH_TOKEN_PATH")
    file = Path(named) if named else Path.home() / DEFAULT_FILE
    try:
        token = file.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(
            f"Expected the token of the Ray cluster in {file} ({error}); `ray get-auth-token --generate` makes one, "
            "and RAY_AUTH_TOKEN or RAY_AUTH_TOKEN_PATH names another"
        ) from error
    if not token:
        raise ConfigError(f"Expected the token of the Ray cluster in {file}, got an empty file")
    return token


def require_authentication(server: Server, address: str, token: str) -> None:
    """Make sure that the Ray server at `host:port` refuses who has no token, and accepts this one.

    The token is sent only after the server has refused a question without it.

    Raises:
        ConfigError: Nobody answers, the server asks for no token, or it has another one.
    """
    code = _ask(server, address, None)
    if code in (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.DEADLINE_EXCEEDED):
        raise ConfigError(f"Expected a Ray {server} at {address}, got no answer")
    if code is not grpc.StatusCode.UNAUTHENTICATED:
        raise ConfigError(
            f"Expected a Ray {server} at {address} that asks for its token, got {code.name} without one; "
            "start its head and its nodes with RAY_AUTH_MODE=token"
        )
    if _ask(server, address, token) is grpc.StatusCode.UNAUTHENTICATED:
        raise ConfigError(f"Expected the token of the Ray {server} at {address}, got another one")


def _ask(server: Server, address: str, token: str | None) -> grpc.StatusCode:
    """Ask a server its question and return the status of the answer."""
    metadata = () if token is None else (("authorization", f"Bearer {token}"),)
    with _channel(address) as channel:
        try:
            channel.unary_unary(METHODS[server])(b"", timeout=TIMEOUT_S, metadata=metadata)
        except grpc.RpcError as error:
            return error.code()
    return grpc.StatusCode.OK


def _channel(address: str) -> grpc.Channel:
    """Open a channel, encrypted if Ray is told so by `RAY_USE_TLS`."""
    options = [("grpc.max_receive_message_length", N_BYTES_MAX), ("grpc.enable_http_proxy", 0)]
    if os.environ.get("RAY_USE_TLS", "0").lower() not in ("1", "true"):
        return grpc.insecure_channel(address, options)
    authority, key, certificate = (
        Path(os.environ[name]).read_bytes() for name in ("RAY_TLS_CA_CERT", "RAY_TLS_SERVER_KEY", "RAY_TLS_SERVER_CERT")
    )
    return grpc.secure_channel(address, grpc.ssl_channel_credentials(authority, key, certificate), options)
