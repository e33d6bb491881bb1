"""An authority from its beginning over renewals to revocations: files, modes, names and states."""

import json
import os
import stat
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from legpush.authority.carry_out import add, begin, listed, renew, revoke
from legpush.authority.register import Host, Register, read_register, write_register
from legpush.bus.secure.certificate_names import PROCESS_ROLES, CertificateRole
from legpush.bus.secure.host_folder import read_access, read_credentials
from legpush.errors import ConfigError, CredentialsError, LegpushError

NOW = datetime.now(UTC)


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    folder = tmp_path / "lab"
    begin(folder, ["robot=10.0.0.7", "laptop"], 30, 60)
    return folder


def states(lab: Path, now: datetime = NOW) -> dict[str, str]:
    """State of each certificate by name, of the roles `sim` and `agent`."""
    return {each.name: each.state for each in listed(lab, now) if each.role in ("sim", "agent")}


def names(lab: Path, host: str = "robot") -> set[str]:
    """Names of simulators that this host lets in."""
    return set(read_access(lab / host / "access.json").names["sim"])


def test_all_that_is_made_is_private_whatever_the_umask_is(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        begin(tmp_path / "lab", ["robot"], 30, 60)
        add(tmp_path / "lab", ["laptop"], 30)
        renew(tmp_path / "lab", [], [], 30)
        revoke(tmp_path / "lab", ["laptop"], [])
    finally:
        os.umask(before)
    modes = {path: stat.S_IMODE(path.stat().st_mode) for path in (tmp_path / "lab", *(tmp_path / "lab").rglob("*"))}
    assert len(modes) > 30
    assert {oct(mode) for path, mode in modes.items() if path.is_dir()} == {"0o700"}
    assert {oct(mode) for path, mode in modes.items() if path.is_file()} == {"0o600"}


def test_each_host_gets_all_roles_and_no_key_of_the_authority(lab: Path) -> None:
    expected = {
        "authority.pem",
        "access.json",
        *(f"{role}.{end}" for role in PROCESS_ROLES for end in ("pem", "key")),
    }
    for host in ("robot", "laptop"):
        assert {path.name for path in (lab / host).iterdir()} == expected
        assert {read_credentials(lab / host, role).name for role in PROCESS_ROLES} == {
            f"{role}.{host}.1" for role in PROCESS_ROLES
        }
    assert {path.name for path in (lab / "authority").iterdir()} == {"authority.pem", "authority.key", "register.json"}


def test_an_empty_folder_may_be_used_and_one_with_files_is_left_alone(lab: Path, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    begin(tmp_path / "empty", ["robot"], 30, 60)
    (tmp_path / "file").touch()
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").touch()
    for folder in (lab, tmp_path / "mine", tmp_path / "file"):
        with pytest.raises(ConfigError, match="Expected a new or empty folder, got"):
            begin(folder, ["robot"], 30, 60)
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize("hosts", [["a", "b", "a"], [], ["a", "a=10.0.0.1"]])
def test_each_host_is_named_once(tmp_path: Path, hosts: list[str]) -> None:
    with pytest.raises(ConfigError, match="Expected each host once, and at least one, got"):
        begin(tmp_path / "new", hosts, 30, 60)
    assert not (tmp_path / "new").exists()


def test_after_an_error_in_the_middle_nothing_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("legpush.authority.carry_out._write_pair", full)
    with pytest.raises(LegpushError, match="No space left"):
        begin(tmp_path / "lab", ["robot"], 30, 60)
    assert list(tmp_path.iterdir()) == []


def test_renewed_certificates_have_other_keys_and_the_next_serial_and_old_hosts_know_them_already(lab: Path) -> None:
    old_key, old_names = (lab / "robot" / "sim.key").read_bytes(), names(lab, "laptop")
    renew(lab, ["robot"], ["sim"], 30)
    assert states(lab) == {
        "sim.robot.2": "valid",
        "agent.robot.1": "valid",
        "sim.laptop.1": "valid",
        "agent.laptop.1": "valid",
    }
    assert (lab / "robot" / "sim.key").read_bytes() != old_key
    assert read_credentials(lab / "robot", "sim").name == "sim.robot.2"
    assert "sim.robot.2" in old_names
    assert {"sim.robot.1", "sim.robot.2", "sim.robot.3"} <= names(lab, "laptop")


def test_all_are_renewed_if_none_is_named(lab: Path) -> None:
    renew(lab, [], [], 30)
    assert set(states(lab)) == {"sim.robot.2", "agent.robot.2", "sim.laptop.2", "agent.laptop.2"}


def test_a_revoked_certificate_is_on_no_list_and_works_no_more(lab: Path) -> None:
    revoke(lab, ["robot"], ["sim"])
    assert states(lab)["sim.robot.1"] == "revoked"
    assert states(lab)["agent.robot.1"] == "valid"
    for host in ("robot", "laptop"):
        assert names(lab, host) == {"sim.laptop.1", "sim.laptop.2", "sim.robot.2"}
    with pytest.raises(CredentialsError, match=r"got sim\.robot\.1, which is none of the names \(it was revoked"):
        read_credentials(lab / "robot", "sim")
    renew(lab, ["robot"], ["sim"], 30)
    assert read_credentials(lab / "robot", "sim").name == "sim.robot.2"
    assert "sim.robot.1" not in names(lab)


def test_an_added_host_is_on_all_lists(lab: Path) -> None:
    add(lab, ["viewer-pc"], 30)
    for host in ("robot", "laptop", "viewer-pc"):
        assert "sim.viewer-pc.1" in names(lab, host)
    assert read_credentials(lab / "viewer-pc", "viewer").name == "viewer.viewer-pc.1"
    with pytest.raises(ConfigError, match="Expected new hosts, got robot; `legpush secure renew`"):
        add(lab, ["new", "robot"], 30)
    assert not (lab / "new").exists()


def test_a_certificate_expires(lab: Path) -> None:
    assert set(states(lab, NOW + timedelta(days=31)).values()) == {"expired"}


@pytest.mark.parametrize("spoil", ["[]", '{"hosts": {"../x": {"addresses": [], "issued": {}}}}', None])
def test_a_register_that_cannot_be_used_is_named(lab: Path, spoil: str | None) -> None:
    file = lab / "authority" / "register.json"
    if spoil is None:
        file.unlink()
    else:
        file.write_text(spoil)
    with pytest.raises(CredentialsError, match=r"(the register of an authority|that `legpush secure init` made)"):
        renew(lab, [], [], 30)


def test_a_host_that_is_not_there_changes_nothing(lab: Path) -> None:
    before = json.loads((lab / "authority" / "register.json").read_text())
    said = "Expected one of the hosts laptop, robot, got 'nobody'"
    with pytest.raises(ConfigError, match=said):
        renew(lab, ["robot", "nobody"], [], 30)
    with pytest.raises(ConfigError, match=said):
        revoke(lab, ["robot", "nobody"], [])
    assert json.loads((lab / "authority" / "register.json").read_text()) == before


def test_only_the_hosts_that_are_named_get_a_certificate_of_a_router(tmp_path: Path) -> None:
    lab = tmp_path / "lab"
    begin(lab, ["hub", "robot"], 1, 1, ["hub"])
    add(lab, ["other", "desk"], 1, ["other"])
    having = {path.parent.name for path in lab.glob("*/router.pem")}
    assert having == {"hub", "other"}
    assert read_credentials(lab / "hub", "router").name == "router.hub.1"
    renew(lab, ["robot", "hub"], ["router"], 1)
    assert [read_credentials(lab / host, "router").name for host in ("robot", "hub")] == [
        "router.robot.1",
        "router.hub.2",
    ]
    assert read_credentials(lab / "robot", "sim").name == "sim.robot.1"
    assert not (lab / "desk" / "router.pem").exists()


@pytest.mark.parametrize("roles", [[], ["worker"]])
def test_a_host_of_an_authority_that_is_older_than_a_role_gets_its_first_certificate(
    tmp_path: Path, roles: list[CertificateRole]
) -> None:
    lab = tmp_path / "lab"
    begin(lab, ["robot"], 1, 1)
    register = read_register(lab)
    older = register.hosts["robot"]
    issued = dict(older.issued)
    del issued["worker"]
    write_register(lab, Register(hosts={"robot": Host(addresses=older.addresses, issued=issued)}))
    for file in (lab / "robot").glob("worker.*"):
        file.unlink()

    renew(lab, [], roles, 1)
    assert read_credentials(lab / "robot", "worker").name == "worker.robot.1"
    assert read_credentials(lab / "robot", "sim").name == f"sim.robot.{1 if roles else 2}"
    assert not (lab / "robot" / "router.pem").exists()


def test_a_router_has_to_be_one_of_the_hosts(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="Expected hosts of desk, robot for --routers, got hub"):
        begin(tmp_path / "lab", ["robot", "desk"], 1, 1, ["hub"])
    assert not (tmp_path / "lab").exists()
