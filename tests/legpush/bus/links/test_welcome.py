"""Only a process with a certificate shakes hands before it opens a session, and with all that it connects to."""

import socket
from contextlib import closing
from pathlib import Path

import pytest

from legpush.bus.endpoints import Endpoints
from legpush.bus.links.welcome import require_welcome
from legpush.bus.secure.host_folder import read_credentials
from legpush.errors import CredentialsError
from tests.security.hosts import HOST, made


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("authority") / "authority", HOST)


def test_without_a_certificate_nobody_is_asked() -> None:
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        server.settimeout(0.2)
        require_welcome(Endpoints(connect=(f"tcp/127.0.0.1:{server.getsockname()[1]}",)))
        with pytest.raises(TimeoutError):
            server.accept()


def test_nobody_there_is_no_refusal(host: Path) -> None:
    require_welcome(Endpoints(connect=("tls/127.0.0.1:1",), credentials=read_credentials(host, "agent")))


def test_what_is_there_and_speaks_no_tls_is_told(host: Path) -> None:
    credentials = read_credentials(host, "agent")
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        at = f"tls/127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(
            CredentialsError, match=r"expected TLS, got no answer to a handshake; this process is agent"
        ):
            require_welcome(Endpoints(connect=("tls/127.0.0.1:1", at), credentials=credentials))
