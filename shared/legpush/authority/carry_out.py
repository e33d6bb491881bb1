"""What `legpush secure` does: begins an authority, adds, renews and revokes certificates, and lists them."""

import secrets
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

import msgspec

from legpush.authority.issue import Issuer, Pair, make_authority
from legpush.authority.register import Host, Issued, Register, parse_host, read_register, write_register
from legpush.bus.secure.certificate import read_certificate
from legpush.bus.secure.certificate_names import (
    OF_ROUTERS,
    PROCESS_ROLES,
    CertificateRole,
    certificate_name,
)
from legpush.bus.secure.host_folder import ACCESS_FILE, AUTHORITY, AUTHORITY_FILE, certificate_file, key_file
from legpush.errors import ConfigError
from legpush.files import make_folder, replace_folder, write_whole

AUTHORITY_KEY_FILE: Final = "authority.key"


class Listed(msgspec.Struct, frozen=True, kw_only=True):
    """A certificate, as `secure show` lists it."""

    name: str
    host: str
    role: CertificateRole
    ends: datetime
    """When it expires; UTC."""
    state: str
    """`valid`, `expired` or `revoked`."""


def begin(folder: Path, hosts: Sequence[str], days: int, authority_days: int, routers: Sequence[str] = ()) -> Register:
    """Make an authority in a new or empty folder, and beside it a folder for each host, which `--secure` takes.

    Only the hosts in `routers` get a certificate of a router.

    Raises:
        ConfigError: The folder has something in it, or a host cannot be used.
        DiskError: A file cannot be written; nothing is left.
    """
    named = _parse_hosts(hosts)
    roles = _roles(named, routers)
    if folder.is_file() or (folder.exists() and any(folder.iterdir())):
        raise ConfigError(
            f"Expected a new or empty folder, got {folder}; `legpush secure add` adds a host to an authority"
        )
    pair = make_authority(f"legpush authority {secrets.token_hex(4)}", authority_days)
    register = Register(hosts={name: _first(addresses, roles[name]) for name, addresses in named.items()})

    def fill(part: Path) -> None:
        part.chmod(0o700)
        make_folder(part / AUTHORITY, private=True)
        write_whole(part / AUTHORITY / AUTHORITY_FILE, pair.certificate, private=True)
        write_whole(part / AUTHORITY / AUTHORITY_KEY_FILE, pair.key, private=True)
        write_register(part, register)
        for name in named:
            _write_host(part, name, register, Issuer(pair), pair.certificate, days, roles[name])

    if folder.exists():
        folder.rmdir()
    replace_folder(folder, fill)
    return register


def add(folder: Path, hosts: Sequence[str], days: int, routers: Sequence[str] = ()) -> Register:
    """Add hosts to an authority.

    Raises:
        ConfigError: A host is there, or cannot be used.
        CredentialsError: It is not the folder of an authority.
        DiskError: A file cannot be written.
    """
    register, named = read_register(folder), _parse_hosts(hosts)
    if there := sorted(named.keys() & register.hosts.keys()):
        raise ConfigError(
            f"Expected new hosts, got {', '.join(there)}; `legpush secure renew` renews their certificates"
        )
    roles = _roles(named, routers)
    added = {name: _first(addresses, roles[name]) for name, addresses in named.items()}
    return _put(folder, Register(hosts={**register.hosts, **added}), roles, days)


def renew(folder: Path, hosts: Sequence[str], roles: Sequence[CertificateRole], days: int) -> Register:
    """Sign certificates with other keys and the next serials, also in the place of revoked ones.

    Without `hosts` or `roles`, all of them. A host that has none of a role gets its first one: of the roles that are
    named, or else of those of processes, as its authority may be older than a role.

    Raises:
        ConfigError: There is no such host.
        CredentialsError: It is not the folder of an authority.
        DiskError: A file cannot be written.
    """
    register = read_register(folder)
    chosen = _chosen(register, hosts, roles)

    def next_one(issued: Issued) -> Issued:
        return Issued(serial=issued.serial + 1, first=issued.first)

    renewed, chosen = _with_new(_changed(register, chosen, next_one), chosen, roles or PROCESS_ROLES)
    return _put(folder, renewed, chosen, days)


def revoke(folder: Path, hosts: Sequence[str], roles: Sequence[CertificateRole]) -> Register:
    """Take the names of certificates off the list; with their keys, nobody takes part any more.

    Raises:
        ConfigError: There is no such host.
        CredentialsError: It is not the folder of an authority.
        DiskError: A file cannot be written.
    """
    register = read_register(folder)

    def none(issued: Issued) -> Issued:
        return Issued(serial=issued.serial, first=issued.serial + 1)

    return _put(folder, _changed(register, _chosen(register, hosts, roles), none), {}, 0)


def listed(folder: Path, now: datetime | None = None) -> Iterator[Listed]:
    """Yield all certificates of an authority, by host and role.

    Raises:
        CredentialsError: It is not the folder of an authority, or a certificate cannot be read.
    """
    now = now or datetime.now(UTC)
    for host, entry in sorted(read_register(folder).hosts.items()):
        for role, issued in entry.issued.items():
            found = read_certificate(certificate_file(folder / host, role))
            state = "revoked" if issued.revoked else "expired" if found.ends <= now else "valid"
            yield Listed(name=found.name, host=host, role=role, ends=found.ends, state=state)


def _put(folder: Path, register: Register, to_sign: Mapping[str, Sequence[CertificateRole]], days: int) -> Register:
    """Write the register and the names first: a certificate that is signed after that is on every list."""
    where = folder / AUTHORITY
    issuer = Issuer.read(where / AUTHORITY_FILE, where / AUTHORITY_KEY_FILE)
    certificate = (where / AUTHORITY_FILE).read_bytes()
    write_register(folder, register)
    for host in register.hosts:
        _write_host(folder, host, register, issuer, certificate, days, to_sign.get(host, ()))
    return register


def _write_host(
    folder: Path,
    host: str,
    register: Register,
    issuer: Issuer,
    authority: bytes,
    days: int,
    roles: Sequence[CertificateRole],
) -> None:
    """Write the folder of a host, with certificates that are signed now for these roles."""
    place, entry = folder / host, register.hosts[host]
    make_folder(place, private=True)
    write_whole(place / AUTHORITY_FILE, authority, private=True)
    names = msgspec.json.format(msgspec.json.encode(register.access()), indent=1) + b"\n"
    write_whole(place / ACCESS_FILE, names, private=True)
    for role in roles:
        name = certificate_name(role, host, entry.issued[role].serial)
        _write_pair(place, role, issuer.issue(name, entry.addresses, days))


def _write_pair(place: Path, role: CertificateRole, pair: Pair) -> None:
    write_whole(key_file(place, role), pair.key, private=True)
    write_whole(certificate_file(place, role), pair.certificate, private=True)


def _first(addresses: tuple[str, ...], roles: Sequence[CertificateRole]) -> Host:
    return Host(addresses=addresses, issued={role: Issued(serial=1, first=1) for role in roles})


def _roles(hosts: Collection[str], routers: Sequence[str]) -> dict[str, tuple[CertificateRole, ...]]:
    """Return the roles for which each host gets a certificate."""
    if unknown := sorted(set(routers) - set(hosts)):
        raise ConfigError(f"Expected hosts of {', '.join(sorted(hosts))} for --routers, got {', '.join(unknown)}")
    return {host: (*PROCESS_ROLES, *((OF_ROUTERS,) if host in routers else ())) for host in hosts}


def _parse_hosts(hosts: Sequence[str]) -> dict[str, tuple[str, ...]]:
    parsed = [parse_host(host) for host in hosts]
    named = dict(parsed)
    if not named or len(named) < len(parsed):
        raise ConfigError(f"Expected each host once, and at least one, got {', '.join(hosts) or 'none'}")
    return named


def _chosen(
    register: Register, hosts: Sequence[str], roles: Sequence[CertificateRole]
) -> dict[str, tuple[CertificateRole, ...]]:
    """Return the roles to change, by host."""
    chosen = hosts or tuple(register.hosts)
    return {host: tuple(role for role in register.host(host).issued if not roles or role in roles) for host in chosen}


def _with_new(
    register: Register, chosen: Mapping[str, Sequence[CertificateRole]], wanted: Sequence[CertificateRole]
) -> tuple[Register, dict[str, tuple[CertificateRole, ...]]]:
    """Add the first certificate of each wanted role to those of the chosen hosts that have none."""
    hosts, roles = dict(register.hosts), {host: tuple(each) for host, each in chosen.items()}
    for host in chosen:
        entry = hosts[host]
        new = tuple(role for role in wanted if role not in entry.issued)
        first = _first(entry.addresses, new)
        hosts[host] = Host(addresses=entry.addresses, issued={**entry.issued, **first.issued})
        roles[host] = (*chosen[host], *new)
    return Register(hosts=hosts), roles


def _changed(
    register: Register, chosen: Mapping[str, Sequence[CertificateRole]], change: Callable[[Issued], Issued]
) -> Register:
    hosts = dict(register.hosts)
    for host, roles in chosen.items():
        issued = {role: change(one) if role in roles else one for role, one in hosts[host].issued.items()}
        hosts[host] = Host(addresses=hosts[host].addresses, issued=issued)
    return Register(hosts=hosts)
