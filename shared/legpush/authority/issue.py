"""Makes keys and signs certificates."""

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path
from typing import Final, NamedTuple

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    load_pem_private_key,
)
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from legpush.errors import CredentialsError

CLOCKS: Final = timedelta(hours=1)
"""A certificate begins this much earlier, since clocks of hosts differ."""
LOOPBACK: Final = ("localhost", "127.0.0.1", "::1")
"""Addresses that every host has for its own processes."""


class Pair(NamedTuple):
    """A certificate and its private key, as PEM."""

    certificate: bytes
    key: bytes


class Issuer:
    """Signs certificates with the key of an authority."""

    def __init__(self, pair: Pair) -> None:
        key = load_pem_private_key(pair.key, password=None)
        if not isinstance(key, ec.EllipticCurvePrivateKey):
            raise TypeError("the key of an authority is one on an elliptic curve")
        self._key = key
        self._certificate = x509.load_pem_x509_certificate(pair.certificate)

    @classmethod
    def read(cls, certificate: Path, key: Path) -> "Issuer":
        """Read an authority from its files.

        Raises:
            CredentialsError: A file cannot be read, or has something else in it.
        """
        try:
            return cls(Pair(certificate.read_bytes(), key.read_bytes()))
        except OSError as error:
            raise CredentialsError(f"{error.filename}: expected a file of the authority ({error.strerror})") from error
        except (ValueError, TypeError) as error:
            raise CredentialsError(f"{key.parent}: expected certificate and key of an authority as PEM") from error

    @property
    def ends(self) -> datetime:
        """When the authority expires; UTC."""
        return self._certificate.not_valid_after_utc

    def issue(self, name: str, addresses: Sequence[str], days: int) -> Pair:
        """Sign a certificate for a process, valid for some days, but not longer than the authority itself.

        Args:
            name: Its common name.
            addresses: Host names and IP addresses at which the process may listen, besides loopback.
            days: How long it is valid.
        """
        key = ec.generate_private_key(ec.SECP256R1())
        now = datetime.now(UTC)
        begins = max(now - CLOCKS, self._certificate.not_valid_before_utc)
        ends = min(now + timedelta(days=days), self.ends)
        usage = x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH])
        hosts = x509.SubjectAlternativeName([_general(each) for each in dict.fromkeys((*addresses, *LOOPBACK))])
        certificate = (
            _builder(name, key, begins, ends)
            .issuer_name(self._certificate.subject)
            .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
            .add_extension(_usage(signs=False), critical=True)
            .add_extension(usage, critical=False)
            .add_extension(hosts, critical=False)
            .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(self._key.public_key()), critical=False)
            .sign(self._key, hashes.SHA256())
        )
        return _pair(certificate, key)


def make_authority(name: str, days: int) -> Pair:
    """Make an authority with a common name; it signs itself."""
    key = ec.generate_private_key(ec.SECP256R1())
    now = datetime.now(UTC)
    certificate = (
        _builder(name, key, now - CLOCKS, now + timedelta(days=days))
        .issuer_name(_named(name))
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(_usage(signs=True), critical=True)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
        .sign(key, hashes.SHA256())
    )
    return _pair(certificate, key)


def _builder(name: str, key: ec.EllipticCurvePrivateKey, begins: datetime, ends: datetime) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(_named(name))
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(begins)
        .not_valid_after(ends)
    )


def _named(name: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])


def _usage(*, signs: bool) -> x509.KeyUsage:
    """An authority signs certificates, and a process signs handshakes."""
    return x509.KeyUsage(
        digital_signature=not signs,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        key_cert_sign=signs,
        crl_sign=signs,
        encipher_only=False,
        decipher_only=False,
    )


def _general(address: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ip_address(address))
    except ValueError:
        return x509.DNSName(address)


def _pair(certificate: x509.Certificate, key: ec.EllipticCurvePrivateKey) -> Pair:
    private = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    return Pair(certificate.public_bytes(Encoding.PEM), private)
