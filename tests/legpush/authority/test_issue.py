"""Certificates have the names, addresses and days that they were asked for, and the authority signs them."""

from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path

import pytest
from cryptography import x509
from cryptography.hazmat.primitives.asymmetric import ed25519
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from cryptography.x509.oid import ExtendedKeyUsageOID

from legpush.authority.issue import Issuer, Pair, make_authority
from legpush.errors import CredentialsError


def parsed(pair: Pair) -> x509.Certificate:
    return x509.load_pem_x509_certificate(pair.certificate)


def test_a_certificate_is_for_both_ends_of_a_link_and_for_the_addresses_of_its_host() -> None:
    certificate = parsed(Issuer(make_authority("a", 9)).issue("sim.robot.1", ("robot", "10.0.0.7", "fd00::1"), 5))
    hosts = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert hosts.get_values_for_type(x509.DNSName) == ["robot", "localhost"]
    assert hosts.get_values_for_type(x509.IPAddress) == [*map(ip_address, ("10.0.0.7", "fd00::1", "127.0.0.1", "::1"))]
    usage = certificate.extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
    assert set(usage) == {ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH}
    assert not certificate.extensions.get_extension_for_class(x509.BasicConstraints).value.ca


def test_an_authority_signs_certificates_but_no_authority_below_it() -> None:
    constraints = parsed(make_authority("a", 9)).extensions.get_extension_for_class(x509.BasicConstraints)
    assert (constraints.critical, constraints.value.ca, constraints.value.path_length) == (True, True, 0)


@pytest.mark.parametrize(("days", "expected"), [(5, 5), (50, 9)])
def test_a_certificate_expires_after_its_days_and_never_after_its_authority(days: int, expected: int) -> None:
    issuer = Issuer(make_authority("a", 9))
    certificate = parsed(issuer.issue("sim.robot.1", (), days))
    ends = certificate.not_valid_after_utc
    assert abs(ends - datetime.now(UTC) - timedelta(days=expected)) < timedelta(minutes=1)
    assert ends <= issuer.ends


def test_two_certificates_share_neither_a_key_nor_a_number() -> None:
    issuer = Issuer(make_authority("a", 9))
    one, other = (issuer.issue("sim.robot.1", (), 5) for _ in range(2))
    assert one.key != other.key
    assert parsed(one).serial_number != parsed(other).serial_number


@pytest.mark.parametrize("spoil", ["missing", "no key", "another kind of key"])
def test_an_authority_that_cannot_be_read_is_named(tmp_path: Path, spoil: str) -> None:
    pair = make_authority("a", 9)
    certificate, key = tmp_path / "authority.pem", tmp_path / "authority.key"
    certificate.write_bytes(pair.certificate)
    if spoil == "no key":
        key.write_bytes(b"no")
    elif spoil == "another kind of key":
        other = ed25519.Ed25519PrivateKey.generate()
        key.write_bytes(other.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()))
    with pytest.raises(CredentialsError, match=f"{tmp_path}.*: expected .* authority"):
        Issuer.read(certificate, key)
