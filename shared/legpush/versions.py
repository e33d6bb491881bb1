"""Versions of the installed packages, as reports, journals and recordings name them."""

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Final, Literal, NamedTuple

from legpush.messages.common import PROTOCOL_VERSION
from legpush.numerics.computed_with import NUMERICS
from legpush.numerics.current import current
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS
from legpush.numerics.profile import glibc_version


class Package(NamedTuple):
    """A package whose version is noted in reports or recordings."""

    distribution: str
    """Name of the distribution, which recordings use."""
    name: str
    """Name in reports and journals."""
    noted_in: tuple[Literal["report", "recording"], ...]
    """`report`: of missions, evaluations and trainings, and in journals. `recording`: in the metadata of recordings."""


PACKAGES: Final = (
    Package("legpush", "legpush", ("report", "recording")),
    Package("eclipse-zenoh", "zenoh", ("report", "recording")),
    Package("mcap", "mcap", ("recording",)),
    Package("mujoco", "mujoco", ("report",)),
    Package("ompl", "ompl", ("report",)),
    Package("numpy", "numpy", ("report",)),
    Package("scipy", "scipy", ("report",)),
    Package("msgpack", "msgpack", ("report", "recording")),
    Package("msgspec", "msgspec", ("report", "recording")),
    Package("matplotlib", "matplotlib", ("report",)),
)
"""A recorder depends on few of them; the results of a mission depend on the others."""


def installed_versions() -> dict[str, str | None]:
    """Return the versions for reports and journals, by name; None for a package that is not installed.

    Among them are the name of the numerics of this process, and the versions of the motions, the protocol and glibc.
    """
    return {
        NUMERICS: current().name,
        MOTIONS: str(MOTION_VERSION),
        "protocol": str(PROTOCOL_VERSION),
        "python": platform.python_version(),
        "glibc": glibc_version() or None,
        **{package.name: _version(package.distribution) for package in PACKAGES if "report" in package.noted_in},
    }


def recorder_versions() -> dict[str, str]:
    """Return the versions of a recorder, by distribution, for the metadata of recordings."""
    return {each.distribution: version(each.distribution) for each in PACKAGES if "recording" in each.noted_in}


def _version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None
