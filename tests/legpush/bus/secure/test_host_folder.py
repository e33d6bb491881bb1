"""The folder behind `--secure`: what is wrong in it is told in one sentence, before anything is opened."""

import json
import logging
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from legpush.authority.carry_out import begin
from legpush.bus.secure.certificate_names import PROCESS_ROLES
from legpush.bus.secure.host_folder import credentials_of, read_credentials
from legpush.errors import CredentialsError, code_of


@pytest.fixture
def host(tmp_path: Path) -> Path:
    begin(tmp_path / "lab", ["robot", "laptop"], 90, 90)
    return tmp_path / "lab" / "robot"


def test_each_role_gets_its_certificate_and_the_names_of_all(host: Path) -> None:
    for role in PROCESS_ROLES:
        credentials = read_credentials(host, role)
        assert credentials.name == f"{role}.robot.1"
        assert credentials.names[role] == tuple(
            f"{role}.{name}.{serial}" for name in ("laptop", "robot") for serial in (1, 2)
        )
        assert credentials.role_of(f"{role}.laptop.2") == role
        assert {credentials.role_of(name) for name in ("", "*", f"{role}.laptop", f"{role}.laptop.22")} == {None}
        assert all(path.is_absolute() for path in (credentials.authority, credentials.certificate, credentials.key))
    assert credentials_of(None, "sim") is None
    assert credentials_of(host, "sim") == read_credentials(host, "sim")


def no_folder(host: Path) -> Path:
    return host / "nowhere"


def folder_of_the_authority(host: Path) -> Path:
    return host.parent


def readable_key(host: Path) -> Path:
    (host / "sim.key").chmod(0o640)
    return host


def writable_names(host: Path) -> Path:
    (host / "access.json").chmod(0o660)
    return host


def writable_folder(host: Path) -> Path:
    host.chmod(0o777)
    return host


def no_certificate(host: Path) -> Path:
    (host / "sim.pem").unlink()
    return host


def no_key(host: Path) -> Path:
    (host / "sim.key").unlink()
    return host


def names_that_are_none(host: Path) -> Path:
    (host / "access.json").write_text("[]")
    return host


def names_of_another_format(host: Path) -> Path:
    (host / "access.json").write_text('{"format": 2, "names": {}}')
    return host


def names_of_an_unknown_role(host: Path) -> Path:
    (host / "access.json").write_text('{"names": {"chief": ["chief.robot.1"]}}')
    return host


def name_with_a_wildcard(host: Path) -> Path:
    (host / "access.json").write_text('{"names": {"sim": ["*"]}}')
    return host


def no_names_of_this_role(host: Path) -> Path:
    (host / "access.json").write_text('{"names": {"agent": ["agent.robot.1"]}}')
    return host


def another_roles_certificate(host: Path) -> Path:
    for ending in ("pem", "key"):
        (host / f"sim.{ending}").write_bytes((host / f"agent.{ending}").read_bytes())
    return host


def revoked(host: Path) -> Path:
    access = json.loads((host / "access.json").read_text())
    access["names"]["sim"].remove("sim.robot.1")
    (host / "access.json").write_text(json.dumps(access))
    return host


WRONG: dict[Callable[[Path], Path], str] = {
    no_folder: r"Expected the folder of a host for --secure, with access\.json in it, got .*nowhere; `legpush secure",
    folder_of_the_authority: r"Expected the folder of a host .*lab/laptop, .*lab/robot\), got that of the authority",
    readable_key: r"sim\.key: expected mode 0600, got 0640: others could use it; `chmod -R go= .*robot` mends that",
    writable_names: r"access\.json: expected a mode in which others cannot write, got 0660: .*; `chmod -R go= .*robot`",
    writable_folder: r"robot: expected a mode in which others cannot write, got 0777: they could let themselves in",
    no_certificate: r"sim\.pem: expected the certificate of a simulator, got no file",
    no_key: r"sim\.key: expected a private key, got no file",
    names_that_are_none: r"access\.json: expected the names of certificates by role \(Expected `object`, got `array`\)",
    names_of_another_format: r"access\.json: .* \(Expected `int` <= 1 - at `\$\.format`\)",
    names_of_an_unknown_role: r"access\.json: .*\(Invalid enum value 'chief'",
    name_with_a_wildcard: r"access\.json: .* at `\$\.names\[\.\.\.\]\[0\]`",
    no_names_of_this_role: r"sim\.pem: expected .* a simulator \(no name in access\.json\), got sim\.robot\.1",
    another_roles_certificate: r"sim\.pem: .* \(sim\.laptop\.1, .*\), got agent\.robot\.1, that of an agent",
    revoked: r"sim\.pem: .*, got sim\.robot\.1, which is none of the names \(it was revoked, or is newer",
}


@pytest.mark.parametrize("spoil", WRONG, ids=lambda spoil: spoil.__name__)
def test_what_is_wrong_is_told_with_the_file_and_the_valid_choices(host: Path, spoil: Callable[[Path], Path]) -> None:
    with pytest.raises(CredentialsError, match=WRONG[spoil]) as raised:
        read_credentials(spoil(host), "sim")
    assert code_of(raised.value) == 2


def test_a_certificate_that_expires_soon_is_told_about(host: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING)
    read_credentials(host, "sim")
    assert caplog.text == ""
    read_credentials(host, "sim", datetime.now(UTC) + timedelta(days=80))
    assert "the certificate sim.robot.1 expires in 10.0 days; `legpush secure renew`" in caplog.text
