"""`legpush secure`: carries out one of its commands, and tells what is to be copied where."""

import sys
from collections.abc import Iterable
from functools import singledispatch
from pathlib import Path

from legpush.authority.carry_out import add, begin, listed, renew, revoke
from legpush.authority.options import AddHosts, BeginAuthority, RenewCertificates, RevokeCertificates, ShowCertificates
from legpush.authority.register import Register
from legpush.bus.secure.host_folder import ACCESS_FILE, AUTHORITY
from legpush.errors import printable
from legpush.options.checks import require_writable_folder
from legpush.output.reply import document


@singledispatch
def run_secure(command: object) -> int:
    """Carry out a command, and return its exit code.

    Raises:
        ConfigError: An option cannot be used.
        CredentialsError: A file of the authority cannot be used.
        DiskError: A file cannot be written.
    """
    raise TypeError(f"Expected a command of legpush secure, got {type(command).__name__}")


@run_secure.register
def _begin(command: BeginAuthority) -> int:
    require_writable_folder(command.folder, "DIR")
    register = begin(command.folder, command.hosts, command.days, command.authority_days, command.routers)
    return _tell(
        command.folder,
        register,
        *_folders(command.folder, register.hosts),
        f"{command.folder / AUTHORITY}: the authority, which signs certificates: keep it to yourself",
    )


@run_secure.register
def _add(command: AddHosts) -> int:
    register = add(command.folder, command.hosts, command.days, command.routers)
    added = [host.partition("=")[0] for host in command.hosts]
    return _tell(command.folder, register, *_folders(command.folder, added), _lists(command.folder))


@run_secure.register
def _renew(command: RenewCertificates) -> int:
    register = renew(command.folder, command.hosts, command.roles, command.days)
    return _tell(command.folder, register, *_folders(command.folder, command.hosts or register.hosts))


@run_secure.register
def _revoke(command: RevokeCertificates) -> int:
    register = revoke(command.folder, command.hosts, command.roles)
    return _tell(command.folder, register, _lists(command.folder))


@run_secure.register
def _show(command: ShowCertificates) -> int:
    found = tuple(listed(command.folder))
    for each in found:
        sys.stdout.write(printable(f"{each.name:<32}{each.state:<9}until {each.ends:%Y-%m-%d %H:%M} UTC") + "\n")
    document(found)
    return 0


def _folders(folder: Path, hosts: Iterable[str]) -> list[str]:
    return [f"{folder / host}: copy it to {host}, for --secure there" for host in sorted(hosts)]


def _lists(folder: Path) -> str:
    return f"{folder}/*/{ACCESS_FILE}: copy it to each host; processes that are started after that obey it"


def _tell(folder: Path, register: Register, *lines: str) -> int:
    sys.stdout.write("".join(f"{printable(line)}\n" for line in lines))
    document({"folder": folder, "hosts": register.hosts, "names": register.access().names})
    return 0
