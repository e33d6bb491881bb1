"""The folder of a host, as `--secure` takes it: certificates and keys of its processes, and the names of all others."""

import logging
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated, Final

import msgspec
from msgspec import Meta, Struct

from legpush.bus.secure.certificate_names import MAX_NAME, WORDS, CertificateRole
from legpush.errors import CredentialsError

AUTHORITY_FILE: Final = "authority.pem"
ACCESS_FILE: Final = "access.json"
REGISTER_FILE: Final = "register.json"
"""In the folder of an authority."""
AUTHORITY: Final = "authority"
"""Name of the folder of an authority, beside those of the hosts."""
FORMAT: Final = 1
WARN: Final = timedelta(days=30)
"""A certificate that expires earlier is told about."""

log = logging.getLogger(__name__)

CertificateName = Annotated[str, Meta(pattern=r"^[A-Za-z0-9.-]+$(?!\n)", max_length=MAX_NAME)]


class Access(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Who may take part: `access.json`, which is the same on all hosts of an authority."""

    format: Annotated[int, Meta(ge=FORMAT, le=FORMAT)] = FORMAT
    names: dict[CertificateRole, tuple[CertificateName, ...]]
    """Names of certificates by role; also the name that each next certificate will have."""


@dataclass(frozen=True, kw_only=True)
class Credentials:
    """With what a process shows who it is, and whose messages it takes."""

    folder: Path
    role: CertificateRole
    name: str
    """Name of its certificate, such as `sim.robot.1`."""
    ends: datetime
    """When its certificate expires; UTC."""
    names: Mapping[CertificateRole, tuple[str, ...]]
    """Names of all certificates that may take part."""

    @property
    def authority(self) -> Path:
        """The certificate of the authority."""
        return self.folder / AUTHORITY_FILE

    @property
    def certificate(self) -> Path:
        """The certificate of this process."""
        return certificate_file(self.folder, self.role)

    @property
    def key(self) -> Path:
        """The private key of this process."""
        return key_file(self.folder, self.role)

    def role_of(self, name: str) -> CertificateRole | None:
        """Return the role of a certificate; None if a process with this name may not take part."""
        return next((role for role, names in self.names.items() if name in names), None)


def credentials_of(folder: Path | None, role: CertificateRole) -> Credentials | None:
    """Return what `--secure` gives a process of this role; None without it.

    Raises:
        CredentialsError: The folder or what is in it cannot be used.
    """
    return None if folder is None else read_credentials(folder, role)


def certificate_file(folder: Path, role: CertificateRole) -> Path:
    """Return the file with the certificate of a role."""
    return folder / f"{role}.pem"


def key_file(folder: Path, role: CertificateRole) -> Path:
    """Return the file with the private key of a role."""
    return folder / f"{role}.key"


def read_credentials(folder: Path, role: CertificateRole, now: datetime | None = None) -> Credentials:
    """Read and check what a process of this role needs, at the time `now`.

    Raises:
        CredentialsError: The folder, a file or its mode, or the certificate cannot be used; names file and certificate.
    """
    from legpush.bus.secure.certificate import own_certificate, require_valid_now

    folder = folder.absolute()
    _require_host_folder(folder)
    now = now or datetime.now(UTC)
    certificate, key = certificate_file(folder, role), key_file(folder, role)
    if not certificate.exists():
        raise CredentialsError(f"{certificate}: expected the certificate of {WORDS[role]}, got no file")
    _require_private(folder, key)
    own = own_certificate(certificate, key, folder / AUTHORITY_FILE)
    require_valid_now(certificate, own, now)
    names = read_access(folder / ACCESS_FILE).names
    credentials = Credentials(folder=folder, role=role, name=own.name, ends=own.ends, names=names)
    _require_role(credentials)
    if own.ends - now < WARN:
        days = (own.ends - now) / timedelta(days=1)
        log.warning("the certificate %s expires in %.1f days; `legpush secure renew` makes another one", own.name, days)
    return credentials


def read_access(path: Path) -> Access:
    """Read who may take part.

    Raises:
        CredentialsError: The file cannot be read, or says something else.
    """
    try:
        return msgspec.json.decode(path.read_bytes(), type=Access)
    except OSError as error:
        raise CredentialsError(f"{path}: expected a file that can be read ({error.strerror})") from error
    except msgspec.MsgspecError as error:
        raise CredentialsError(f"{path}: expected the names of certificates by role ({error})") from error


def _require_host_folder(folder: Path) -> None:
    if (folder / ACCESS_FILE).is_file():
        return
    if (folder / AUTHORITY / REGISTER_FILE).is_file():
        hosts = sorted(path.parent for path in folder.glob(f"*/{ACCESS_FILE}"))
        raise CredentialsError(
            f"Expected the folder of a host for --secure ({', '.join(map(str, hosts)) or 'there is none yet'}), "
            f"got that of the authority, {folder}"
        )
    raise CredentialsError(
        f"Expected the folder of a host for --secure, with {ACCESS_FILE} in it, got {folder}; `legpush secure init` "
        "makes it"
    )


def _require_private(folder: Path, key: Path) -> None:
    """Require that nobody else can read the key, or change what decides who may take part."""
    if not key.is_file():
        raise CredentialsError(f"{key}: expected a private key, got no file")
    cure = f"`chmod -R go= {folder}` mends that"
    if (mode := stat.S_IMODE(key.stat().st_mode)) & 0o077:
        raise CredentialsError(f"{key}: expected mode 0600, got {mode:04o}: others could use it; {cure}")
    for path in (folder, folder / ACCESS_FILE, folder / AUTHORITY_FILE):
        if path.exists() and (mode := stat.S_IMODE(path.stat().st_mode)) & 0o022:
            raise CredentialsError(
                f"{path}: expected a mode in which others cannot write, got {mode:04o}: they could let themselves in; "
                f"{cure}"
            )


def _require_role(credentials: Credentials) -> None:
    """Require that the certificate is one of its role, by the names on this host."""
    name, role = credentials.name, credentials.role
    got = credentials.role_of(name)
    if got == role:
        return
    there = ", ".join(credentials.names.get(role, ())) or "no name"
    what = "which is none of the names (it was revoked, or is newer than the file)" if got is None else WORDS[got]
    raise CredentialsError(
        f"{credentials.certificate}: expected the certificate of {WORDS[role]} ({there} in {ACCESS_FILE}), got {name}, "
        f"{what if got is None else f'that of {what}'}"
    )
