"""Hosts with certificates, good and bad ones, and raw sessions that check and obey nothing of their own."""

import json
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, Final, Literal

import msgspec
import zenoh
from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.serialization import Encoding, load_pem_private_key
from cryptography.x509.oid import NameOID

from legpush.authority.carry_out import AUTHORITY_KEY_FILE, begin
from legpush.authority.issue import Issuer, Pair
from legpush.bus.secure.certificate_names import CertificateRole
from legpush.bus.secure.host_folder import ACCESS_FILE, AUTHORITY, AUTHORITY_FILE, certificate_file, key_file
from legpush.files import write_whole
from tests.ports import free_ports

HOST: Final = "robot"
EXPIRED: Final = (-2.0, -1.0)
NOT_YET: Final = (1.0, 2.0)
"""Days from now between which a certificate is valid."""


def made(folder: Path, *hosts: str, routers: Sequence[str] = ()) -> Path:
    """Make an authority, and return the folder of its first host."""
    begin(folder, hosts or (HOST,), 90, 90, routers)
    return folder / (hosts[0].partition("=")[0] if hosts else HOST)


def copied(host: Path, to: Path) -> Path:
    """Return a copy of the folder of a host."""
    return Path(shutil.copytree(host, to))


def issuer_of(host: Path) -> Issuer:
    """Return the authority of a host."""
    folder = host.parent / AUTHORITY
    return Issuer.read(folder / AUTHORITY_FILE, folder / AUTHORITY_KEY_FILE)


def give(host: Path, role: CertificateRole, pair: Pair) -> Path:
    """Put a certificate and its key in the place of those of a role; returns the folder of the host."""
    write_whole(certificate_file(host, role), pair.certificate, private=True)
    write_whole(key_file(host, role), pair.key, private=True)
    return host


def let_in(host: Path, role: CertificateRole, name: str) -> Path:
    """Add a name to those that this host lets in."""
    access = json.loads((host / ACCESS_FILE).read_text())
    access["names"][role].append(name)
    write_whole(host / ACCESS_FILE, msgspec.json.encode(access), private=True)
    return host


def valid_between(authority: Path, name: str, days: tuple[float, float]) -> Pair:
    """Sign a certificate that is valid between these days from now."""
    folder = authority / AUTHORITY
    issuer = x509.load_pem_x509_certificate((folder / AUTHORITY_FILE).read_bytes())
    key = load_pem_private_key((folder / AUTHORITY_KEY_FILE).read_bytes(), None)
    pair = Issuer.read(folder / AUTHORITY_FILE, folder / AUTHORITY_KEY_FILE).issue(name, (), 1)
    like = x509.load_pem_x509_certificate(pair.certificate)
    now = datetime.now(UTC)
    builder = (
        x509.CertificateBuilder()
        .subject_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)]))
        .issuer_name(issuer.subject)
        .public_key(like.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now + timedelta(days=days[0]))
        .not_valid_after(now + timedelta(days=days[1]))
    )
    for extension in like.extensions:
        builder = builder.add_extension(extension.value, extension.critical)
    signed = builder.sign(key, hashes.SHA256())  # type: ignore[arg-type]
    return Pair(signed.public_bytes(Encoding.PEM), pair.key)


def free_endpoint() -> str:
    """Return a TLS port of 127.0.0.1 on which nobody listens."""
    return f"tls/127.0.0.1:{free_ports(1)[0]}"


@contextmanager
def raw_session(
    host: Path | None,
    role: CertificateRole,
    *,
    listen: Sequence[str] = (),
    connect: Sequence[str] = (),
    access: dict[str, Any] | None = None,
    mode: Literal["peer", "client", "router"] = "peer",
) -> Iterator[zenoh.Session]:
    """Open a session with the certificate of a role, without a check of its own; None has no certificate."""
    tls: dict[str, Any] = {"verify_name_on_connect": False}
    if host is not None:
        certificate, key = str(certificate_file(host, role)), str(key_file(host, role))
        tls |= {
            "root_ca_certificate": str(host / AUTHORITY_FILE),
            "enable_mtls": True,
            "close_link_on_expiration": True,
            **{f"{side}_certificate": certificate for side in ("listen", "connect")},
            **{f"{side}_private_key": key for side in ("listen", "connect")},
        }
    settings: dict[str, Any] = {
        "mode": mode,
        "listen/endpoints": list(listen),
        "connect/endpoints": list(connect),
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "connect/retry": {"period_init_ms": 50, "period_max_ms": 200, "period_increase_factor": 1.5},
        "open/return_conditions/connect_scouted": False,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "transport/link/tls": tls,
    }
    if access is not None:
        settings["access_control"] = access
    config = zenoh.Config()
    for path, value in settings.items():
        config.insert_json5(path, json.dumps(value))
    with zenoh.open(config) as session:
        yield session
