"""Shakes hands with a listening process once, to learn who is there and whether it takes this process's certificate.

Zenoh tries again and again and says nothing about a certificate that is refused; this handshake says why.
"""

import re
import socket
import ssl
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any, Final, NamedTuple

from legpush.bus.secure.certificate_names import WORDS
from legpush.bus.secure.host_folder import Credentials
from legpush.errors import CredentialsError, one_line

CONNECT_S: Final = 2.0
"""Longest time for a connection, and for a handshake on it."""
VERDICT_S: Final = 0.6
"""In TLS 1.3 a client is told after its handshake that its certificate is refused. No word for this long means that it
is taken."""
_LOCATOR: Final = re.compile(r"tls/(?:\[(?P<six>[^\]]+)\]|(?P<host>[^:?#]+)):(?P<port>\d+)(?:[?#].*)?")
_EXPIRED, _NOT_YET, _OTHER_NAME, _OTHER_ADDRESS = 10, 9, 62, 64
"""Codes of OpenSSL for the certificate of the other side."""
_ALERTS: Final = (
    ("CERTIFICATE_EXPIRED", "it is not valid at the time that the clock there shows"),
    ("UNKNOWN_CA", "another authority signed it"),
    ("CERTIFICATE_REVOKED", "it is revoked"),
    ("CERTIFICATE_REQUIRED", "it was not shown"),
    ("BAD_CERTIFICATE", "it cannot be used there"),
)
"""Words of OpenSSL for what the other side said about this certificate, and what they mean."""


class Verdict(NamedTuple):
    """What came out of a handshake."""

    reached: bool
    """Whether anybody listens there."""
    refusal: str | None = None
    """Why no link will come about; None if nothing speaks against it."""
    silence: str | None = None
    """What was not answered where somebody took the connection, such as a process that is stopped."""


def shake_hands(locator: str, credentials: Credentials) -> Verdict:
    """Shake hands with what listens at `tls/HOST:PORT`, and end the connection.

    Raises:
        CredentialsError: The files of the certificate cannot be used, as while they are replaced.
    """
    address = _LOCATOR.fullmatch(locator)
    if address is None:
        return Verdict(reached=False)
    host, port = address["six"] or address["host"], int(address["port"])
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.minimum_version = ssl.TLSVersion.TLSv1_3
    try:
        context.load_verify_locations(credentials.authority)
        context.load_cert_chain(credentials.certificate, credentials.key)
    except OSError as error:
        raise CredentialsError(
            f"Expected a certificate with its key in {credentials.folder}, got files that do not fit ({error})"
        ) from error
    try:
        connection = socket.create_connection((host, port), timeout=CONNECT_S)
    except OSError:
        return Verdict(reached=False)
    with connection:
        return _verdict(connection, context, host, locator, credentials)


def require_accepted(
    locators: tuple[str, ...], credentials: Credentials, *, one_is_enough: bool = False
) -> tuple[str, ...]:
    """Shake hands with all that listen there already; returns what was not answered.

    Raises:
        CredentialsError: One of them refuses this process, or is refused; says why, and under which name. Where
            `one_is_enough`, all that are there have to.
    """
    if not locators:
        return ()
    with ThreadPoolExecutor(len(locators), thread_name_prefix="handshake") as threads:
        verdicts = list(threads.map(lambda locator: shake_hands(locator, credentials), locators))
    refusals = [verdict.refusal for verdict in verdicts if verdict.refusal is not None]
    is_accepted = any(verdict.reached and verdict.refusal is None for verdict in verdicts)
    if refusals and not (one_is_enough and is_accepted):
        raise CredentialsError(*refusals)
    return tuple(verdict.silence for verdict in verdicts if verdict.silence is not None)


def _verdict(
    connection: socket.socket, context: ssl.SSLContext, host: str, locator: str, credentials: Credentials
) -> Verdict:
    """Return what comes out of a handshake on this connection."""
    own = f"this process is {credentials.name} of {credentials.folder}"
    try:
        with context.wrap_socket(connection, server_hostname=host) as link:
            name = _common_name(link.getpeercert())
            link.settimeout(VERDICT_S)
            with suppress(TimeoutError):
                link.recv(1)
    except ssl.SSLCertVerificationError as error:
        return Verdict(True, f"{locator}: expected a certificate {_wanted(error, locator)}; {own}")
    except ssl.SSLError as error:
        return Verdict(True, f"{locator}: {_alert(error, credentials)}; {own}")
    except TimeoutError:
        return Verdict(False, silence=f"{locator} takes connections and does not answer a handshake of TLS")
    except OSError:  # the other side ended while it was asked
        return Verdict(True)
    if credentials.role_of(name) is None:
        listed = ", ".join(word for role, word in WORDS.items() if credentials.names.get(role))
        return Verdict(
            True,
            f"{locator}: expected a certificate that may take part ({listed}), got {name or 'one without a name'}, "
            f"which is none of the names on this host; {own}",
        )
    return Verdict(True)


def _common_name(certificate: Any) -> str:
    """Return the common name in a certificate as `ssl` shows it; an empty text if it has none."""
    names = dict(part[0] for part in (certificate or {}).get("subject", ()))
    return one_line(str(names.get("commonName", "")))


def _wanted(error: ssl.SSLCertVerificationError, locator: str) -> str:
    """Return what is expected of the certificate of the other side, and what came."""
    if error.verify_code == _EXPIRED:
        return "that is valid, got one that has expired"
    if error.verify_code == _NOT_YET:
        return "that is valid, got one that is not valid yet by the clock of this machine"
    if error.verify_code in (_OTHER_NAME, _OTHER_ADDRESS):
        return (
            f"for the address of {locator}, got one for other addresses; connect to one of those that `legpush secure "
            "init` was given"
        )
    return f"of the authority of this host, got one that another authority signed ({error.verify_message})"


def _alert(error: ssl.SSLError, credentials: Credentials) -> str:
    """Return what the other side said about the certificate of this process, or about TLS."""
    reason = error.reason or str(error)
    for word, meaning in _ALERTS:
        if word in reason:
            return f"the process there refuses the certificate {credentials.name}: {meaning}"
    if "ALERT" in reason:
        return f"the process there refuses the certificate {credentials.name} ({reason.lower().replace('_', ' ')})"
    return f"expected TLS 1.3, got something else ({reason.lower().replace('_', ' ')})"
