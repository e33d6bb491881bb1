"""Reads the certificate and the key of a process, and checks that they belong together and to an authority."""

from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey
from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat, load_pem_private_key
from cryptography.x509.oid import NameOID

from legpush.errors import CredentialsError, one_line


class Certificate(NamedTuple):
    """What a certificate says."""

    name: str
    """Its common name."""
    begins: datetime
    ends: datetime
    """When it becomes valid and expires; UTC."""


def read_certificate(path: Path) -> Certificate:
    """Read a certificate in the format PEM.

    Raises:
        CredentialsError: The file cannot be read, or is no certificate with one common name.
    """
    return _facts(path, _load(path))


def own_certificate(certificate: Path, key: Path, authority: Path) -> Certificate:
    """Read the certificate of this process, which has to fit its key and be signed by the authority.

    Raises:
        CredentialsError: A file cannot be used, or they do not belong together; names the file.
    """
    own, issuer = _load(certificate), _load(authority)
    try:
        private = load_pem_private_key(_bytes(key), password=None)
    except (ValueError, TypeError) as error:
        raise CredentialsError(f"{key}: expected a private key in the format PEM without a password") from error
    if not isinstance(private, EllipticCurvePrivateKey) or _spki(private.public_key()) != _spki(own.public_key()):
        raise CredentialsError(f"{key}: expected the key of {certificate.name}, got another one")
    facts = _facts(certificate, own)
    try:
        own.verify_directly_issued_by(issuer)
    except (ValueError, TypeError, InvalidSignature) as error:
        raise CredentialsError(
            f"{certificate}: expected a certificate of the authority in {authority.name}, got {facts.name}, which "
            "another authority signed"
        ) from error
    return facts


def require_valid_now(path: Path, certificate: Certificate, now: datetime) -> None:
    """Check that a certificate is valid at this time.

    Raises:
        CredentialsError: It is not; names it, and the time that decides.
    """
    if now >= certificate.ends:
        raise CredentialsError(
            f"{path}: expected a certificate that is valid, but {certificate.name} expired at "
            f"{_when(certificate.ends)}; `legpush secure renew` makes another one"
        )
    if now < certificate.begins:
        raise CredentialsError(
            f"{path}: expected a certificate that is valid, but {certificate.name} begins at "
            f"{_when(certificate.begins)}, and the clock of this machine says {_when(now)}"
        )


def _facts(path: Path, certificate: x509.Certificate) -> Certificate:
    names = certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME)
    if len(names) != 1:
        raise CredentialsError(f"{path}: expected a certificate with one common name, got {len(names)}")
    name = str(names[0].value)
    return Certificate(one_line(name), certificate.not_valid_before_utc, certificate.not_valid_after_utc)


def _load(path: Path) -> x509.Certificate:
    try:
        return x509.load_pem_x509_certificate(_bytes(path))
    except ValueError as error:
        raise CredentialsError(f"{path}: expected a certificate in the format PEM") from error


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise CredentialsError(f"{path}: expected a file that can be read ({error.strerror})") from error


def _spki(key: object) -> bytes:
    """Return the bytes of a public key."""
    encoded: bytes = key.public_bytes(Encoding.DER, PublicFormat.SubjectPublicKeyInfo)  # type: ignore[attr-defined]
    return encoded


def _when(time: datetime) -> str:
    return f"{time.astimezone(UTC):%Y-%m-%d %H:%M:%S} UTC"
