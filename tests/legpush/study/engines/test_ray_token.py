"""The check that a Ray server asks for its token, against servers of gRPC that do and do not."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import grpc
import pytest

from legpush.errors import ConfigError
from legpush.study.engines import ray_token
from legpush.study.engines.ray_token import METHODS, Server, read_token, require_authentication
from tests.ports import free_ports

TOKEN = "t" * 64
SERVERS: tuple[Server, ...] = ("head", "client server")


class FakeRay:
    """Answers one method; asks for a token if it has one."""

    def __init__(self, method: str, token: str | None) -> None:
        self.method = method
        self.token = token
        self.got: list[str | None] = []

    def handler(self) -> Any:
        """Return what a server of gRPC needs."""
        service, method = self.method.strip("/").split("/")
        methods = {method: grpc.unary_unary_rpc_method_handler(self._answer)}
        return grpc.method_handlers_generic_handler(service, methods)

    def _answer(self, _: bytes, context: Any) -> bytes:
        given = dict(context.invocation_metadata()).get("authorization")
        self.got.append(given)
        if self.token is not None and given != f"Bearer {self.token}":
            context.abort(grpc.StatusCode.UNAUTHENTICATED, "no")
        return b""


@pytest.fixture
def serve() -> Iterator[Callable[[FakeRay], str]]:
    """A function that serves a fake and returns its address."""
    with ExitStack() as stack:

        def start(fake: FakeRay) -> str:
            server = grpc.server(ThreadPoolExecutor(1), handlers=(fake.handler(),))
            port = server.add_insecure_port("127.0.0.1:0")
            server.start()
            stack.callback(lambda: server.stop(None).wait())
            return f"127.0.0.1:{port}"

        yield start


@pytest.fixture(autouse=True)
def no_token(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A user without a token."""
    for name in ("RAY_AUTH_TOKEN", "RAY_AUTH_TOKEN_PATH", "RAY_USE_TLS"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))


@pytest.mark.parametrize("server", SERVERS)
def test_a_server_that_asks_for_this_token_is_accepted(server: Server, serve: Callable[[FakeRay], str]) -> None:
    fake = FakeRay(METHODS[server], TOKEN)
    require_authentication(server, serve(fake), TOKEN)
    assert fake.got == [None, f"Bearer {TOKEN}"]


@pytest.mark.parametrize("server", SERVERS)
def test_a_server_that_asks_for_none_is_refused_and_never_sees_the_token(
    server: Server, serve: Callable[[FakeRay], str]
) -> None:
    fake = FakeRay(METHODS[server], None)
    with pytest.raises(ConfigError, match=r"asks for its token, got OK without one.*RAY_AUTH_MODE=token"):
        require_authentication(server, serve(fake), TOKEN)
    assert fake.got == [None]


@pytest.mark.parametrize("server", SERVERS)
def test_a_server_with_another_token_is_refused(server: Server, serve: Callable[[FakeRay], str]) -> None:
    with pytest.raises(ConfigError, match="got another one"):
        require_authentication(server, serve(FakeRay(METHODS[server], "other")), TOKEN)


def test_a_server_that_does_not_know_the_question_is_refused(serve: Callable[[FakeRay], str]) -> None:
    fake = FakeRay("/another/Method", TOKEN)
    with pytest.raises(ConfigError, match="got UNIMPLEMENTED without one"):
        require_authentication("head", serve(fake), TOKEN)


def test_an_address_where_nobody_listens_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ray_token, "TIMEOUT_S", 2.0)
    (port,) = free_ports(1)
    with pytest.raises(ConfigError, match=f"at 127.0.0.1:{port}, got no answer"):
        require_authentication("head", f"127.0.0.1:{port}", TOKEN)


def test_the_token_is_read_where_ray_reads_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ConfigError, match=r"ray get-auth-token --generate"):
        read_token()
    (tmp_path / ".ray").mkdir()
    (tmp_path / ".ray" / "auth_token").write_text("at home\n")
    assert read_token() == "at home"
    (tmp_path / "named").write_text("in a file")
    monkeypatch.setenv("RAY_AUTH_TOKEN_PATH", str(tmp_path / "named"))
    assert read_token() == "in a file"
    monkeypatch.setenv("RAY_AUTH_TOKEN", "in the environment")
    assert read_token() == "in the environment"


def test_an_empty_file_is_no_token(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "empty").write_text("\n")
    monkeypatch.setenv("RAY_AUTH_TOKEN_PATH", str(tmp_path / "empty"))
    with pytest.raises(ConfigError, match="empty file"):
        read_token()
