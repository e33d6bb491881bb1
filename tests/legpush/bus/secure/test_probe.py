"""A handshake says who listens, and why one side refuses the other."""

import re
import socket
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

import pytest

from legpush.bus.endpoints import Endpoints
from legpush.bus.secure.host_folder import read_credentials
from legpush.bus.secure.probe import Verdict, require_accepted, shake_hands
from legpush.bus.session import ZenohSession
from legpush.errors import CredentialsError
from tests.ports import free_ports
from tests.security.hosts import (
    EXPIRED,
    copied,
    free_endpoint,
    give,
    issuer_of,
    made,
    raw_session,
    valid_between,
)


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("authority") / "authority")


@pytest.fixture(scope="module")
def simulator(host: Path) -> Iterator[str]:
    """The place where a simulator listens."""
    at = free_endpoint()
    with closing(ZenohSession(Endpoints(listen=(at,), credentials=read_credentials(host, "sim")), "sim main")):
        yield at


@contextmanager
def serving(answer: bytes) -> Iterator[str]:
    """A place where something listens that is no TLS: it sends this and waits."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(10.0)

        def serve() -> None:
            connection, _ = server.accept()
            with connection, suppress(ConnectionResetError):
                connection.sendall(answer)
                while connection.recv(4096):
                    pass

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield f"tls/127.0.0.1:{server.getsockname()[1]}"
        thread.join()


def test_a_process_that_takes_the_certificate_has_nothing_against_it(host: Path, simulator: str) -> None:
    agent = read_credentials(host, "agent")
    assert shake_hands(simulator, agent) == Verdict(reached=True)
    require_accepted((simulator, simulator), agent)


@pytest.mark.parametrize("locator", ["tls/127.0.0.1:1", "tls/[::1]:1", "tls/no.such.host.invalid:7"])
def test_a_place_where_nobody_listens_is_not_reached_and_refuses_nothing(host: Path, locator: str) -> None:
    assert shake_hands(locator, read_credentials(host, "agent")) == Verdict(reached=False)
    require_accepted((locator,), read_credentials(host, "agent"))


def test_the_other_side_refuses_an_expired_certificate(host: Path, simulator: str, tmp_path: Path) -> None:
    here = copied(host, tmp_path / "robot")
    agent = read_credentials(here, "agent")
    give(here, "agent", valid_between(host.parent, "agent.robot.1", EXPIRED))
    refusal = shake_hands(simulator, agent).refusal
    assert refusal == (
        f"{simulator}: the process there refuses the certificate agent.robot.1: it is not valid at the time that the "
        f"clock there shows; this process is agent.robot.1 of {here}"
    )


def test_the_other_side_refuses_a_certificate_of_another_authority(host: Path, simulator: str, tmp_path: Path) -> None:
    here = copied(host, tmp_path / "robot")
    agent = read_credentials(here, "agent")
    give(here, "agent", issuer_of(made(tmp_path / "other")).issue("agent.robot.1", (), 1))
    assert "refuses the certificate agent.robot.1: another authority signed it" in str(
        shake_hands(simulator, agent).refusal
    )


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("stranger", "expected a certificate of the authority of this host, got one that another authority signed"),
        ("expired", "expected a certificate that is valid, got one that has expired"),
        ("unlisted", r"expected a certificate that may take part \(a planner, .*\), got sim.other.1, which is none of"),
    ],
)
def test_this_side_refuses_a_certificate(host: Path, tmp_path: Path, kind: str, said: str) -> None:
    there = copied(host, tmp_path / "robot")
    if kind == "stranger":
        there = made(tmp_path / "other")
    elif kind == "expired":
        give(there, "sim", valid_between(host.parent, "sim.robot.1", EXPIRED))
    elif kind == "unlisted":
        give(there, "sim", issuer_of(host).issue("sim.other.1", (), 1))
    at = free_endpoint()
    with raw_session(there, "sim", listen=[at]), pytest.raises(CredentialsError, match=said) as raised:
        require_accepted((at,), read_credentials(host, "agent"))
    assert f"this process is agent.robot.1 of {host}" in str(raised.value)


def test_a_certificate_is_for_the_addresses_that_its_host_was_given(host: Path, tmp_path: Path) -> None:
    there = made(tmp_path / "lab", "robot=127.0.0.3")
    port = free_ports(1)[0]
    with raw_session(there, "sim", listen=[f"tls/0.0.0.0:{port}"]):
        agent = read_credentials(there, "agent")
        assert shake_hands(f"tls/127.0.0.3:{port}", agent) == Verdict(reached=True)
        refusal = str(shake_hands(f"tls/127.0.0.2:{port}", agent).refusal)
    assert f"for the address of tls/127.0.0.2:{port}, got one for other addresses; connect to one of those" in refusal


def test_what_is_no_tls_is_told(host: Path) -> None:
    with serving(b"HTTP/1.1 400 Bad Request\r\n\r\n") as at:
        refusal = str(shake_hands(at, read_credentials(host, "agent")).refusal)
    assert re.match(rf"{at}: expected TLS 1\.3, got something else \(.*\); this process is agent\.robot\.1", refusal)


def test_what_never_answers_is_told_and_refuses_nothing(host: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It may be a process that is stopped, and goes on."""
    monkeypatch.setattr("legpush.bus.secure.probe.CONNECT_S", 0.2)
    with serving(b"") as at:
        silences = require_accepted((at,), read_credentials(host, "agent"))
    assert silences == (f"{at} takes connections and does not answer a handshake of TLS",)


def test_one_that_accepts_is_enough_where_one_is_asked_for(host: Path, simulator: str) -> None:
    agent = read_credentials(host, "agent")
    with serving(b"HTTP/1.1 400 Bad Request\r\n\r\n") as other:
        assert require_accepted((other, simulator), agent, one_is_enough=True) == ()
    with serving(b"HTTP/1.1 400 Bad Request\r\n\r\n") as other, pytest.raises(CredentialsError, match=other):
        require_accepted((other, simulator), agent)
    with serving(b"HTTP/1.1 400 Bad Request\r\n\r\n") as other, pytest.raises(CredentialsError, match=other):
        require_accepted((other, "tls/127.0.0.1:1"), agent, one_is_enough=True)


def test_files_that_do_not_fit_are_told(host: Path, tmp_path: Path) -> None:
    """As for a moment while renewed ones are copied."""
    here = copied(host, tmp_path / "robot")
    agent = read_credentials(here, "agent")
    agent.key.write_bytes(read_credentials(here, "sim").key.read_bytes())
    with pytest.raises(
        CredentialsError, match=rf"Expected a certificate with its key in {here}, got files that do not"
    ):
        shake_hands("tls/127.0.0.1:1", agent)
