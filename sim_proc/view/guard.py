"""Guards the page: viser answers only requests for the page's own address that carry its token."""

import logging
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from http import HTTPStatus
from io import StringIO
from typing import Any, Final

import viser
import websockets.asyncio.server
from viser import _messages
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from legpush.errors import ConfigError

VERSIONS: Final = "1.1."
"""Beginning of the versions of viser that are known to ask the guard."""
LOOPBACK: Final = ("localhost", "127.0.0.1", "[::1]")
"""Names of this machine that always are names of the page."""
HTTP_PORT: Final = 80
"""Port that browsers leave out of addresses."""
FIELD: Final = "token="
"""Beginning of the field with the token in the query of an address."""
FOREIGN: Final = (
    "This request is not for the address of this page, or another page sent it. "
    "Open the address that legpush view printed in its terminal, with the same port.\n"
)
UNKNOWN: Final = (
    "This request lacks the token of this page. "
    "Open the address that legpush view printed in its terminal: it contains the token.\n"
)
HEADERS: Final = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
"""Headers of every HTTP answer: other pages can neither frame nor load the page, and nothing keeps or sends on the
address with the token."""


class Guard:
    """Refuses requests for other hosts, from other pages, or without the token; one for each server."""

    def __init__(self, host: str) -> None:
        """`host` is the value of `--host`: one more name of the page."""
        self.token = secrets.token_urlsafe()
        self._names = (*LOOPBACK, in_address(host))

    def answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answer a request or a WebSocket handshake; None if viser shall answer it.

        A valid token in the address of the page is moved into a cookie, by a redirect.
        """
        address, port = connection.local_address[:2]
        path, _, query = request.path.partition("?")
        if not path.startswith("/") or not _is_own(request.headers, (*self._names, in_address(address)), port):
            return _refusal(FOREIGN)
        fields = query.split("&")
        if self._is_token(each.removeprefix(FIELD) for each in fields if each.startswith(FIELD)):
            if path != "/" or "Upgrade" in request.headers:
                return None
            others = "&".join(each for each in fields if not each.startswith(FIELD))
            return _response(
                HTTPStatus.SEE_OTHER,
                "",
                {
                    "Location": f"/?{others}" if others else "/",
                    "Set-Cookie": f"{cookie_name(port)}={self.token}; HttpOnly; SameSite=Strict; Path=/",
                },
            )
        return None if self._is_token(_cookies(request.headers, cookie_name(port))) else _refusal(UNKNOWN)

    def _is_token(self, values: Iterator[str]) -> bool:
        """Whether one of the values is the token; the time does not tell how much of it is right."""
        return any(secrets.compare_digest(each.encode(errors="replace"), self.token.encode()) for each in values)


def start_server(host: str, port: int) -> tuple[viser.ViserServer, str]:
    """Start a viser server behind a guard; returns the server and the token of its page.

    Raises:
        ConfigError: This version of viser does not let itself be guarded; nothing is served.
    """
    if not viser.__version__.startswith(VERSIONS):
        raise ConfigError(_unguarded("its version is not known to ask the guard"))
    guard = Guard(host)
    with _asked_before_viser(guard.answer) as servers, redirect_stdout(StringIO()):  # viser prints a banner
        server = viser.ViserServer(host=host, port=port, label="legpush", verbose=False)
        if not servers or not _stop_sharing(server):
            server.stop()
            raise ConfigError(_unguarded("its server did not take the guard, or its sharing cannot be switched off"))
    logging.getLogger("websockets.server").addFilter(_is_no_bad_request)
    return server, guard.token


def in_address(host: str) -> str:
    """The host as it is written in addresses, where IPv6 is in brackets."""
    return f"[{host}]" if ":" in host else host.lower()


def cookie_name(port: int) -> str:
    """Name of the cookie: browsers send cookies to all ports of a host, and each port can have its own page."""
    return f"legpush-view-{port}"


def _is_own(headers: Headers, names: tuple[str, ...], port: int) -> bool:
    """Whether a request is for the page by one of its names, and sent by no page or by this one."""
    hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
    own = {f"{name}:{port}" for name in names} | (set(names) if port == HTTP_PORT else set())
    return len(hosts) == 1 and hosts[0].lower() in own and origins in ([], [f"http://{hosts[0].lower()}"])


def _cookies(headers: Headers, name: str) -> Iterator[str]:
    """Values of the cookies of this name; those of other programs on this machine may have any form."""
    for header in headers.get_all("Cookie"):
        for cookie in header.split(";"):
            key, _, value = cookie.strip().partition("=")
            if key == name:
                yield value


def _refusal(sentence: str) -> Response:
    """The answer to a request that is refused."""
    return _response(HTTPStatus.FORBIDDEN, sentence, {"Content-Type": "text/plain; charset=utf-8"})


def _response(status: HTTPStatus, text: str, headers: dict[str, str]) -> Response:
    """An HTTP answer, after which the connection is closed."""
    body = text.encode()
    fields = Headers(**headers, **{"Connection": "close", "Content-Length": str(len(body))})
    return Response(status.value, status.phrase, fields, body)


@contextmanager
def _asked_before_viser(answer: Callable[[ServerConnection, Request], Response | None]) -> Iterator[list[object]]:
    """While it lasts, servers of websockets ask `answer` before their own hook; yields those that were made.

    viser 1.1 has no option for its hook `process_request`, so the function that it calls to listen is replaced.
    """
    module, serve = vars(websockets.asyncio.server), websockets.asyncio.server.serve
    made: list[object] = []

    def guarded_serve(*given: Any, process_request: Any = None, **options: Any) -> object:
        def process(connection: ServerConnection, request: Request) -> Response | None:
            response = answer(connection, request)
            if response is None and process_request is not None:
                response = process_request(connection, request)
            if response is not None:
                response.headers.update(HEADERS)
            return response

        made.append(serve(*given, process_request=process, **options))
        return made[-1]

    module["serve"] = guarded_serve
    try:
        yield made
    finally:
        module["serve"] = serve


def _stop_sharing(server: viser.ViserServer) -> bool:
    """Make viser ignore messages that ask for a public address of the page; whether its handlers were found."""
    try:
        for message in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
            server._websock_server.unregister_handler(message)
    except (AttributeError, AssertionError, KeyError):
        return False
    return True


def _unguarded(reason: str) -> str:
    """Error message for a viser that cannot be guarded."""
    return f"Expected viser {VERSIONS}x, whose page can be guarded, got viser {viser.__version__}: {reason}"


def _is_no_bad_request(record: logging.LogRecord) -> bool:
    """Whether a line of the log is about something else than a connection that sent no valid request."""
    return record.getMessage() != "opening handshake failed"
