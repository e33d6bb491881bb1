"""Certificates and keys that do not belong together, or are none, are refused with the file that is wrong."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric import ed25519
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat

from legpush.authority.issue import Issuer, make_authority
from legpush.bus.secure.certificate import own_certificate, read_certificate, require_valid_now
from legpush.errors import CredentialsError

NAME = "sim.robot.1"


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path, Path]:
    """Certificate, key and authority."""
    authority = make_authority("authority", 3)
    pair = Issuer(authority).issue(NAME, (), 2)
    paths = tmp_path / "sim.pem", tmp_path / "sim.key", tmp_path / "authority.pem"
    for path, data in zip(paths, (pair.certificate, pair.key, authority.certificate), strict=True):
        path.write_bytes(data)
    return paths


def test_a_certificate_says_its_name_and_when_it_is_valid(files: tuple[Path, Path, Path]) -> None:
    own = own_certificate(*files)
    assert own == read_certificate(files[0])
    assert own.name == NAME
    assert abs(own.ends - datetime.now(UTC) - timedelta(days=2)) < timedelta(minutes=1)
    assert own.begins < datetime.now(UTC)
    require_valid_now(files[0], own, datetime.now(UTC))


@pytest.mark.parametrize(("days", "said"), [(2.1, "sim.robot.1 expired at"), (-1.0, "sim.robot.1 begins at")])
def test_a_certificate_that_is_not_valid_says_so_with_the_time(
    files: tuple[Path, Path, Path], days: float, said: str
) -> None:
    with pytest.raises(CredentialsError, match=rf"sim\.pem: expected a certificate that is valid, but {said} \d{{4}}-"):
        require_valid_now(files[0], own_certificate(*files), datetime.now(UTC) + timedelta(days=days))


def other_kind() -> bytes:
    """A key on another curve."""
    return ed25519.Ed25519PrivateKey.generate().private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())


@pytest.mark.parametrize(
    ("index", "data", "said"),
    [
        (0, b"", r"sim\.pem: expected a certificate in the format PEM"),
        (0, b"-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n", r"sim\.pem: expected a certificate"),
        (1, b"\xff", r"sim\.key: expected a private key in the format PEM without a password"),
        (1, make_authority("a", 1).key, r"sim\.key: expected the key of sim\.pem, got another one"),
        (1, other_kind(), r"sim\.key: expected the key of sim\.pem, got another one"),
        (2, make_authority("a", 1).certificate, r"sim\.pem: .* in authority\.pem, got sim\.robot\.1, which another"),
        (2, b"no", r"authority\.pem: expected a certificate in the format PEM"),
    ],
)
def test_a_file_with_something_else_is_named(
    files: tuple[Path, Path, Path], index: int, data: bytes, said: str
) -> None:
    files[index].write_bytes(data)
    with pytest.raises(CredentialsError, match=said):
        own_certificate(*files)


@pytest.mark.parametrize("index", range(3))
def test_a_file_that_is_not_there_is_named(files: tuple[Path, Path, Path], index: int) -> None:
    files[index].unlink()
    with pytest.raises(CredentialsError, match=rf"{files[index].name}: expected a file that can be read \(No such"):
        own_certificate(*files)
