"""The register of an authority: its hosts, their addresses, and the serial of each certificate."""

import re
from ipaddress import ip_address
from pathlib import Path
from typing import Annotated, Final

import msgspec
from msgspec import Meta, Struct

from legpush.bus.secure.certificate_names import CERTIFICATE_ROLES, CertificateRole, certificate_name
from legpush.bus.secure.host_folder import AUTHORITY, FORMAT, REGISTER_FILE, Access
from legpush.errors import ConfigError, CredentialsError
from legpush.files import write_whole

MAX_SERIAL: Final = 10**9
Serial = Annotated[int, Meta(ge=1, le=MAX_SERIAL)]
HostName = Annotated[str, Meta(pattern=r"^[A-Za-z0-9](?:[A-Za-z0-9-]{0,38}[A-Za-z0-9])?$(?!\n)")]
"""A label of a DNS name, short enough for the name of a certificate."""
_LABEL: Final = r"[A-Za-z0-9]([A-Za-z0-9-]{0,61}[A-Za-z0-9])?"
_DNS: Final = re.compile(rf"(?=.{{1,253}}\Z){_LABEL}(\.{_LABEL})*")


class Issued(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The certificate of a role on a host."""

    serial: Serial
    """Of the latest certificate."""
    first: Serial
    """The first one that may take part; a revoked one lies before it."""

    @property
    def revoked(self) -> bool:
        """Whether the latest certificate may not take part."""
        return self.first > self.serial

    def serials(self) -> range:
        """Return the serials that may take part: the latest one, the one before it, and the next one.

        The one before it may belong to a host that has not got its renewed certificate yet. The next one is listed so
        that hosts with an older list let it in; nobody has it before the authority signs it.
        """
        return range(max(self.first, self.serial - 1), self.serial + 2)


class Host(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A host with a certificate for each role."""

    addresses: tuple[str, ...]
    issued: dict[CertificateRole, Issued]


class Register(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All hosts of an authority, by name."""

    format: Annotated[int, Meta(ge=FORMAT, le=FORMAT)] = FORMAT
    hosts: dict[HostName, Host]

    def access(self) -> Access:
        """Return who may take part."""
        names: dict[CertificateRole, tuple[str, ...]] = dict.fromkeys(CERTIFICATE_ROLES, ())
        for host, entry in sorted(self.hosts.items()):
            for role, issued in entry.issued.items():
                names[role] += tuple(certificate_name(role, host, serial) for serial in issued.serials())
        return Access(names=names)

    def host(self, name: str) -> Host:
        """Return a host.

        Raises:
            ConfigError: There is none of this name; names those that there are.
        """
        if name not in self.hosts:
            raise ConfigError(f"Expected one of the hosts {', '.join(sorted(self.hosts))}, got {name!r}")
        return self.hosts[name]


def read_register(folder: Path) -> Register:
    """Read the register in the folder that `secure init` has made.

    Raises:
        CredentialsError: There is none, or it says something else.
    """
    file = folder / AUTHORITY / REGISTER_FILE
    try:
        return msgspec.json.decode(file.read_bytes(), type=Register)
    except OSError as error:
        raise CredentialsError(
            f"{folder}: expected the folder that `legpush secure init` made, with {AUTHORITY}/{REGISTER_FILE} in it "
            f"({error.strerror})"
        ) from error
    except msgspec.MsgspecError as error:
        raise CredentialsError(f"{file}: expected the register of an authority ({error})") from error


def write_register(folder: Path, register: Register) -> None:
    """Write the register.

    Raises:
        DiskError: It cannot be written; the previous one is unchanged.
    """
    text = msgspec.json.format(msgspec.json.encode(register), indent=1) + b"\n"
    write_whole(folder / AUTHORITY / REGISTER_FILE, text, private=True)


def parse_host(text: str) -> tuple[str, tuple[str, ...]]:
    """Parse a host on a command line, `NAME` or `NAME=ADDRESS,ADDRESS`; returns its name and its addresses.

    The name is an address, too.

    Raises:
        ConfigError: It has another form; says which.
    """
    name, _, listed = text.partition("=")
    addresses = tuple(part for part in listed.split(",") if part)
    try:
        msgspec.convert(name, HostName)
    except msgspec.ValidationError as error:
        raise ConfigError(
            "Expected a host as NAME or NAME=ADDRESS,ADDRESS, with a name of 1 to 40 letters, digits and -, got "
            f"{text!r}"
        ) from error
    if name == AUTHORITY:
        raise ConfigError(f"Expected another name than {AUTHORITY} for a host: that is the folder of the authority")
    for address in addresses:
        _require_address(address, text)
    return name, tuple(dict.fromkeys((name, *addresses)))


def _require_address(address: str, text: str) -> None:
    try:
        ip_address(address)
    except ValueError as error:
        if _DNS.fullmatch(address) is None:
            raise ConfigError(f"Expected a DNS name or an IP address in {text!r}, got {address!r}") from error
