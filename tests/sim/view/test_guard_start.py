"""The start of a guarded server: its token, its version of viser, and what is switched off."""

import socket
import threading
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
import viser
import websockets.asyncio.server
from viser import _messages
from viser.infra import _infra

from legpush.errors import ConfigError
from sim_proc.view.guard import UNKNOWN, Guard, start_server
from tests.sim.view.guarded import (
    OWN_HOST,
    PATIENCE_S,
    Served,
    answer,
    client,
    is_refused,
    request,
    serve,
)


def test_each_server_has_a_long_token_of_its_own() -> None:
    tokens = {Guard("localhost").token for _ in range(100)}
    assert len(tokens) == 100
    assert min(map(len, tokens)) >= 43


def test_tokens_are_compared_in_constant_time(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    compared = []

    def compare(*both: bytes) -> bool:
        compared.append(both)
        return False

    monkeypatch.setattr("secrets.compare_digest", compare)
    for target, header in (("/?token=wrong", "A: b"), ("/", "Cookie: legpush-view-{port}=wrong")):
        assert is_refused(answer(served.port, request(target, *map(served.fill, (OWN_HOST, header)))), UNKNOWN)
    assert compared == [(b"wrong", served.token.encode())] * 2


@pytest.mark.parametrize("kind", ["ShareUrlRequest", "ShareUrlDisconnect"])
def test_messages_that_ask_for_a_public_address_have_no_effect(monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    served = serve("127.0.0.1")
    try:
        asked, arrived = threading.Event(), threading.Event()
        for method in ("request_share_url", "disconnect_share_url"):
            monkeypatch.setattr(served.server, method, asked.set)
        assert getattr(_messages, kind) not in served.server._websock_server._incoming_handlers
        served.server._websock_server.register_handler(getattr(_messages, kind), lambda *_: arrived.set())
        with client(served, Cookie=served.cookie) as opened:
            opened.send(msgspec.msgpack.encode({"type": kind}))
            assert arrived.wait(PATIENCE_S)
        assert not asked.wait(0.2)
    finally:
        served.server.stop()


def test_an_unknown_version_of_viser_is_not_started(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viser, "__version__", "1.2.0")
    monkeypatch.setattr(viser, "ViserServer", None)
    with pytest.raises(ConfigError, match=r"viser 1\.1\.x.*got viser 1\.2\.0"):
        start_server("127.0.0.1", 0)


def does_not_take_the_guard(monkeypatch: pytest.MonkeyPatch) -> None:
    serve = SimpleNamespace(serve=websockets.asyncio.server.serve)
    parts = {name: getattr(websockets, name) for name in ("datastructures", "exceptions")}
    monkeypatch.setattr(_infra, "websockets", SimpleNamespace(asyncio=SimpleNamespace(server=serve), **parts))


def shares_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    register = _infra.WebsockMessageHandler.register_handler

    def register_others(self: Any, message: Any, callback: Any) -> None:
        if message is not _messages.ShareUrlRequest:
            register(self, message, callback)

    monkeypatch.setattr(_infra.WebsockMessageHandler, "register_handler", register_others)


@pytest.mark.parametrize("is_other", [does_not_take_the_guard, shares_elsewhere])
def test_a_viser_that_cannot_be_guarded_is_stopped_and_named(
    monkeypatch: pytest.MonkeyPatch, is_other: Callable[[pytest.MonkeyPatch], None]
) -> None:
    made = []

    class Server(viser.ViserServer):
        def __init__(self, **options: Any) -> None:
            super().__init__(**options)
            made.append(self.get_port())

    monkeypatch.setattr(viser, "ViserServer", Server)
    is_other(monkeypatch)
    with pytest.raises(ConfigError, match=f"got viser {viser.__version__}: "):
        start_server("127.0.0.1", 0)
    assert len(made) == 1
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", made[0]))


def test_websockets_is_as_before_once_the_server_runs(served: Served) -> None:
    assert websockets.asyncio.server.serve.__module__ == "websockets.asyncio.server"
    assert served.port > 0
