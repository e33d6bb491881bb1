"""Options of `legpush secure`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

from legpush.arguments import USUAL_OUTPUT, OutputOptions, Positional, arg
from legpush.bounds import ValidDays
from legpush.bus.secure.certificate_names import CertificateRole
from legpush.errors import ConfigError
from legpush.fields import require

USUAL_DAYS: Final = 365
AUTHORITY_DAYS: Final = 3650
THIS_HOST: Final = "localhost"
Folder = Positional[Annotated[Path, arg("DIR")]]
Days = Annotated[int, arg("N")]
Hosts = Positional[Annotated[tuple[str, ...], arg("HOST[=ADDRESS,...]")]]
Routers = Annotated[tuple[str, ...], arg("HOST ...")]
Names = Positional[Annotated[tuple[str, ...], arg("HOST")]]


@dataclass(frozen=True, kw_only=True)
class BeginAuthority:
    """Make a certificate authority in a new folder, and for each host a folder of certificates, keys and access rules.

    Copy the folder of each host there, and give it to its processes as `--secure DIR`. Keep DIR/authority to yourself.
    Exit codes: 0 made, 2 bad input.
    """

    folder: Folder
    """The new folder."""
    hosts: Hosts = (THIS_HOST,)
    """The hosts, each with the DNS names and IP addresses at which others connect to it, such as robot=10.0.0.7. The
    name is an address, too, and so is loopback."""
    routers: Routers = ()
    """Those of the hosts on which `legpush router` runs. Only they get a certificate of a router, which all trust."""
    days: Days = USUAL_DAYS
    """How long the certificates are valid."""
    authority_days: Days = AUTHORITY_DAYS
    """How long the authority is valid."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(ValidDays, self.days, "--days", "days")
        require(ValidDays, self.authority_days, "--authority-days", "days")


@dataclass(frozen=True, kw_only=True)
class AddHosts:
    """Add hosts to an authority. All hosts get the names of the added ones: copy their `access.json` there again.

    Exit codes: 0 added, 2 bad input.
    """

    folder: Folder
    """The folder that `legpush secure init` made."""
    hosts: Hosts = ()
    """The hosts, as for `legpush secure init`."""
    routers: Routers = ()
    """Those of the hosts on which `legpush router` runs. Only they get a certificate of a router, which all trust."""
    days: Days = USUAL_DAYS
    """How long the certificates are valid."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(ValidDays, self.days, "--days", "days")


@dataclass(frozen=True, kw_only=True)
class RenewCertificates:
    """Make certificates with other keys and the next serials, also in the place of revoked ones.

    A host that had none of a role gets one: of the roles of processes, and with `--roles router` that of a router.

    Copy the folders of these hosts there again; hosts that have not got theirs yet still work. Exit codes: 0 renewed,
    2 bad input.
    """

    folder: Folder
    """The folder that `legpush secure init` made."""
    hosts: Names = ()
    """Only these hosts; all of them if none is given."""
    roles: Annotated[tuple[CertificateRole, ...], arg()] = ()
    """Only these roles."""
    days: Days = USUAL_DAYS
    """How long the certificates are valid."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(ValidDays, self.days, "--days", "days")


@dataclass(frozen=True, kw_only=True)
class RevokeCertificates:
    """Take certificates off the list of those that may take part, such as after a host was lost.

    Copy `access.json` to all other hosts: a process that is started there after that lets them in no more. Exit codes:
    0 revoked, 2 bad input.
    """

    folder: Folder
    """The folder that `legpush secure init` made."""
    hosts: Names = ()
    """The hosts whose certificates are revoked."""
    roles: Annotated[tuple[CertificateRole, ...], arg()] = ()
    """Only these roles."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        if not self.hosts:
            raise ConfigError("Expected the hosts whose certificates are revoked, got none")


@dataclass(frozen=True, kw_only=True)
class ShowCertificates:
    """List the certificates of an authority: name, when it expires, and whether it may take part.

    Exit codes: 0 listed, 2 bad input.
    """

    folder: Folder
    """The folder that `legpush secure init` made."""
    output: OutputOptions = USUAL_OUTPUT
