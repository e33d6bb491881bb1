"""The guard of the page, met by raw clients: who gets an answer of viser, and who gets one sentence."""

import logging
from types import SimpleNamespace
from typing import cast

import pytest
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.exceptions import InvalidStatus
from websockets.http11 import Request

from sim_proc.view.guard import FOREIGN, UNKNOWN, Guard
from tests.chromium import until
from tests.sim.view.guarded import (
    OWN_HOST,
    PATIENCE_S,
    SCENE,
    UPGRADE,
    Served,
    answer,
    client,
    is_refused,
    request,
    serve,
)


@pytest.mark.parametrize("upgrade", [(), UPGRADE], ids=["http", "websocket"])
@pytest.mark.parametrize(
    "headers",
    [
        (),
        ("Cookie: {token}",),
        ("Cookie: legpush-view-{port}=",),
        ("Cookie: legpush-view-{port}=" + "A" * 43,),
        ("Cookie: legpush-view-{port}={token}A",),
        ("Cookie: legpush-view-1={token}",),
        ("Cookie: other=legpush-view-{port}={token}",),
        ("Authorization: Bearer {token}",),
        ("Referer: http://127.0.0.1:{port}/?token={token}",),
    ],
)
@pytest.mark.parametrize("target", ["/", "/?token=", "/?token=wrong", "/?token=\xff", "/?other={token}", "/index.html"])
def test_a_request_without_the_token_is_refused(
    served: Served, target: str, headers: tuple[str, ...], upgrade: tuple[str, ...]
) -> None:
    given = map(served.fill, ("Host: 127.0.0.1:{port}", *headers))
    said = answer(served.port, request(served.fill(target), *given, *upgrade))
    assert is_refused(said, UNKNOWN)
    assert "legpush view printed" in UNKNOWN


@pytest.mark.parametrize("upgrade", [(), UPGRADE], ids=["http", "websocket"])
@pytest.mark.parametrize(
    ("target", "headers"),
    [
        ("/", ("Host: evil.example",)),
        ("/", ("Host: evil.example:{port}",)),
        ("/", ("Host: localhost.evil.example:{port}",)),
        ("/", ("Host: localhost.:{port}",)),
        ("/", ("Host: evil@localhost:{port}",)),
        ("/", ("Host: localhost",)),
        ("/", ("Host: localhost:1",)),
        ("/", ("Host: 127.0.0.2:{port}",)),
        ("/", ("Host: 0.0.0.0:{port}",)),
        ("/", ("Host:",)),
        ("/", ()),
        ("/", (OWN_HOST, "Host: evil.example")),
        ("/", (OWN_HOST, OWN_HOST)),
        ("/", ("X-Forwarded-Host: 127.0.0.1:{port}", "Host: evil.example:{port}")),
        ("/", (OWN_HOST, "Origin: http://evil.example")),
        ("/", (OWN_HOST, "Origin: http://127.0.0.1:1")),
        ("/", (OWN_HOST, "Origin: http://127.0.0.1")),
        ("/", (OWN_HOST, "Origin: https://127.0.0.1:{port}")),
        ("/", (OWN_HOST, "Origin: http://localhost:{port}")),
        ("/", (OWN_HOST, "Origin: null")),
        ("/", (OWN_HOST, "Origin:")),
        ("/", (OWN_HOST, "Origin: http://127.0.0.1:{port}", "Origin: http://evil.example")),
        ("http://127.0.0.1:{port}/", (OWN_HOST,)),
        ("http://evil.example/", (OWN_HOST,)),
        ("127.0.0.1:{port}", (OWN_HOST,)),
        ("*", (OWN_HOST,)),
    ],
)
def test_a_request_for_another_host_or_from_another_page_is_refused_even_with_the_token(
    served: Served, target: str, headers: tuple[str, ...], upgrade: tuple[str, ...]
) -> None:
    given = map(served.fill, (*headers, "Cookie: {cookie}"))
    said = answer(served.port, request(served.fill(f"{target}?token={{token}}"), *given, *upgrade))
    assert is_refused(said, FOREIGN)
    assert "legpush view printed" in FOREIGN


@pytest.mark.parametrize(
    "target", ["/../pyproject.toml", "/%2e%2e/%2e%2e/__init__.py", "//etc/passwd", "/..\\..\\__init__.py"]
)
def test_paths_lead_out_of_the_page_for_nobody(served: Served, target: str) -> None:
    assert is_refused(answer(served.port, request(target, served.fill(OWN_HOST))), UNKNOWN)
    said = answer(served.port, request(target, *map(served.fill, (OWN_HOST, "Cookie: {cookie}"))))
    assert said.startswith(b"HTTP/1.1 404 ")
    assert said.endswith(b"\r\n\r\n")


@pytest.mark.parametrize(
    "sent",
    [
        b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 0\r\n\r\n",
        b"GET / HTTP/1.0\r\n\r\n",
        b"GET /\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(100) + b"\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost : 127.0.0.1\r\n\r\n",
        b"GET /" + b"a" * 20000 + b" HTTP/1.1\r\n\r\n",
    ],
)
def test_what_is_no_get_request_gets_nothing_and_no_line_in_the_log(
    served: Served, sent: bytes, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    logger = logging.getLogger("websockets.server")
    without_viser = [each for each in logger.filters if type(each).__name__ != "NoHttpErrors"]
    monkeypatch.setattr(logger, "filters", without_viser)  # viser adds its own with the first page that it serves
    with caplog.at_level(logging.WARNING):
        try:
            said = answer(served.port, sent)
        except ConnectionResetError:
            said = b""
    assert said == b"" or said.startswith((b"HTTP/1.1 400 ", b"HTTP/1.1 414 ", b"HTTP/1.1 431 "))
    assert len(said) < 1000
    assert caplog.records == []


def test_the_token_becomes_a_cookie_and_leaves_the_address(served: Served) -> None:
    for target, location in (
        ("/?token={token}", "/"),
        ("/?token={token}&fixedDpr=0.5", "/?fixedDpr=0.5"),
        ("/?a=1&token={token}&b", "/?a=1&b"),
        ("/?token=old&token={token}", "/"),
    ):
        said = answer(served.port, request(served.fill(target), served.fill(OWN_HOST)))
        head, _, body = said.partition(b"\r\n\r\n")
        lines = head.decode().split("\r\n")
        assert lines[0] == "HTTP/1.1 303 See Other"
        assert f"Location: {location}" in lines
        assert f"Set-Cookie: {served.cookie}; HttpOnly; SameSite=Strict; Path=/" in lines
        assert body == b""


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "LocalHost", "[::1]"])
@pytest.mark.parametrize("others", ["", "; a", 'other={{"x": "y"}}; =; '])
def test_the_cookie_opens_the_page_by_each_of_its_names(served: Served, host: str, others: str) -> None:
    cookie = f"Cookie: {others}{{cookie}}" if others.endswith("; ") else f"Cookie: {{cookie}}{others}"
    headers = (f"Host: {host}:{{port}}", f"Origin: http://{host.lower()}:{{port}}", cookie)
    said = answer(served.port, request("/", *map(served.fill, headers)))
    head, _, body = said.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 200 OK")
    assert b"<!doctype html>" in body
    assert b"frame-ancestors 'none'" in head
    assert b"Referrer-Policy: no-referrer" in head


@pytest.mark.parametrize("with_cookie", [False, True])
def test_a_client_with_the_token_gets_the_scene(served: Served, with_cookie: bool) -> None:
    headers = {"Cookie": served.cookie} if with_cookie else {}
    with client(served, "" if with_cookie else f"?token={served.token}", **headers) as opened:
        until(lambda: SCENE in cast(bytes, opened.recv(PATIENCE_S)), "the scene")


def test_a_client_of_another_page_gets_none_of_it(served: Served) -> None:
    with pytest.raises(InvalidStatus) as refused:
        client(served, f"?token={served.token}", Origin="http://evil.example", Cookie=served.cookie)
    assert refused.value.response.body == FOREIGN.encode()


def test_every_address_of_this_machine_is_a_name_if_all_are_listened_on() -> None:
    served = serve("0.0.0.0")
    try:
        for host, sentence in (
            ("127.0.0.2", ""),
            ("0.0.0.0", ""),
            ("localhost", ""),
            ("127.0.0.3", FOREIGN),
            ("evil.example", FOREIGN),
        ):
            headers = map(served.fill, (f"Host: {host}:{{port}}", "Cookie: {cookie}"))
            said = answer(served.port, request("/", *headers), host="127.0.0.2")
            assert said.startswith(b"HTTP/1.1 200 OK") if not sentence else is_refused(said, sentence)
    finally:
        served.server.stop()


@pytest.mark.parametrize(
    ("host", "address", "port", "named", "is_own"),
    [
        ("Robot.example", "192.0.2.7", 8765, "robot.example:8765", True),
        ("robot.example", "192.0.2.7", 8765, "ROBOT.example:8765", True),
        ("robot.example", "192.0.2.7", 8765, "192.0.2.7:8765", True),
        ("robot.example", "192.0.2.7", 8765, "192.0.2.8:8765", False),
        ("127.0.0.1", "127.0.0.1", 8765, "robot.example:8765", False),
        ("::", "2001:db8::7", 8765, "[2001:db8::7]:8765", True),
        ("::", "2001:db8::7", 8765, "[2001:db8::8]:8765", False),
        ("localhost", "::1", 8765, "[::1]:8765", True),
        ("localhost", "::1", 80, "localhost", True),
        ("localhost", "::1", 80, "localhost:80", True),
        ("localhost", "::1", 80, "evil.example", False),
    ],
)
def test_the_names_of_the_page(host: str, address: str, port: int, named: str, is_own: bool) -> None:
    connection = cast(ServerConnection, SimpleNamespace(local_address=(address, port, 0, 0)))
    refused = Guard(host).answer(connection, Request("/", Headers(Host=named)))
    assert refused is not None
    assert refused.body.decode() == (UNKNOWN if is_own else FOREIGN)
