"""The register: which serials may take part after any renewals and revocations, and which hosts can be named."""

from typing import Literal

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.authority.register import Host, HostName, Issued, Register, parse_host
from legpush.bus.secure.certificate_names import CertificateRole
from legpush.errors import ConfigError

STEPS = st.lists(st.sampled_from(["renew", "revoke"]), max_size=12)


def changed(issued: Issued, step: Literal["renew", "revoke"]) -> Issued:
    """What the commands do to a certificate."""
    if step == "renew":
        return Issued(serial=issued.serial + 1, first=issued.first)
    return Issued(serial=issued.serial, first=issued.serial + 1)


@given(STEPS)
def test_a_revoked_certificate_never_takes_part_again_and_a_renewed_one_always_does(
    steps: list[Literal["renew", "revoke"]],
) -> None:
    issued, signed, gone = Issued(serial=1, first=1), {1}, set[int]()
    for step in steps:
        before = issued.serials()
        issued = changed(issued, step)
        if step == "renew":
            signed.add(issued.serial)
            assert issued.serial in before, "hosts with the list before this renewal would refuse the renewed one"
        else:
            gone |= signed
        allowed = set(issued.serials())
        assert not allowed & gone
        assert (issued.serial in allowed) is (issued.serial not in gone)
        assert issued.revoked is (issued.serial in gone)
        assert len(allowed) <= 3
        assert issued.serial + 1 in allowed


def test_the_names_of_all_hosts_are_listed_by_role() -> None:
    issued: dict[CertificateRole, Issued] = {"sim": Issued(serial=2, first=1)}
    register = Register(hosts={name: Host(addresses=(name,), issued=issued) for name in ("b", "a")})
    assert register.access().names["sim"] == ("sim.a.1", "sim.a.2", "sim.a.3", "sim.b.1", "sim.b.2", "sim.b.3")
    assert register.access().names["viewer"] == ()


def test_an_unknown_host_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(ConfigError, match="Expected one of the hosts a, b, got 'c'"):
        Register(hosts={name: Host(addresses=(), issued={}) for name in "ba"}).host("c")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("robot", ("robot", ("robot",))),
        ("robot=10.0.0.7", ("robot", ("robot", "10.0.0.7"))),
        ("r-2=lab.example.org,fd00::1,10.0.0.7", ("r-2", ("r-2", "lab.example.org", "fd00::1", "10.0.0.7"))),
        ("robot=robot,robot", ("robot", ("robot",))),
    ],
)
def test_a_host_has_a_name_and_addresses(text: str, expected: tuple[str, tuple[str, ...]]) -> None:
    assert parse_host(text) == expected


@pytest.mark.parametrize("text", ["", "=10.0.0.7", "a b", "a.b", "a_b", "-a", "a-", "a" * 41, "../a", "a\n", "*", "ä"])
def test_a_name_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match="Expected a host as NAME or NAME=ADDRESS,ADDRESS, with a name of 1 to 40"):
        parse_host(text)


@pytest.mark.parametrize("address", ["10.0.0.7:17472", "tls/10.0.0.7", "a b", "-x", "a..b", "a" * 300, "[::1]"])
def test_an_address_that_is_none_is_refused(address: str) -> None:
    with pytest.raises(ConfigError, match="Expected a DNS name or an IP address in 'robot=") as raised:
        parse_host(f"robot={address}")
    assert repr(address) in str(raised.value)


def test_the_name_of_the_authoritys_folder_is_none_for_a_host() -> None:
    with pytest.raises(ConfigError, match="Expected another name than authority"):
        parse_host("authority")


@given(st.text(max_size=50))
def test_a_text_is_a_host_or_a_clear_error(text: str) -> None:
    try:
        name, addresses = parse_host(text)
    except ConfigError:
        return
    msgspec.convert(name, HostName)
    assert addresses[0] == name
