"""Only a process with a certificate shakes hands before it opens a session, and with all that it connects to."""

import socket
from contextlib import closing
from pathlib import Path

import pytest

from legpush.bus.endpoints import Endpoints, Mode
from legpush.bus.links.welcome import require_welcome
from legpush.bus.secure.host_folder import read_credentials
from legpush.bus.session import ZenohSession
from legpush.errors import CredentialsError
from tests.security.hosts import HOST, free_endpoint, made


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


@pytest.mark.parametrize("mode", ["peer", "client"])
def test_what_is_there_and_does_not_answer_is_named_and_refuses_nothing(
    host: Path, mode: Mode, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("legpush.bus.secure.probe.CONNECT_S", 0.2)
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        at = f"tls/127.0.0.1:{server.getsockname()[1]}"
        places = Endpoints(connect=("tls/127.0.0.1:1", at), credentials=read_credentials(host, "agent"), mode=mode)
        assert require_welcome(places) == (f"{at} takes connections and does not answer a handshake of TLS",)


def test_a_client_needs_one_router_that_takes_it_and_a_peer_all(
    host: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    other = made(tmp_path_factory.mktemp("other") / "authority", HOST)
    ours, theirs = free_endpoint(), free_endpoint()
    credentials = read_credentials(host, "agent")
    with (
        closing(ZenohSession(Endpoints(listen=(ours,), credentials=read_credentials(host, "sim")), "sim")),
        closing(ZenohSession(Endpoints(listen=(theirs,), credentials=read_credentials(other, "sim")), "sim")),
    ):
        assert require_welcome(Endpoints(connect=(theirs, ours), credentials=credentials, mode="client")) == ()
        for refused in (
            Endpoints(connect=(theirs, ours), credentials=credentials),
            Endpoints(connect=(theirs,), credentials=credentials, mode="client"),
        ):
            with pytest.raises(CredentialsError, match="another authority signed"):
                require_welcome(refused)
