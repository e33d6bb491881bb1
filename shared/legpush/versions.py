"""Versions of the installed packages, as reports, journals and recordings name them."""

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Final, Literal, NamedTuple

from legpush.messages.common import PROTOCOL_VERSION


class Package(NamedTuple):
    """A package whose version is noted somewhere."""

    distribution: str
    """Name of the distribution, by which recordings call it."""
    name: str
    """Name in reports and journals."""
    noted_in: tuple[Literal["report", "recording"], ...]
    """A report is one of a mission, of an evaluation or of a training; journals note the same."""


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
"""A recorder needs few of them; what a mission computes depends on the rest."""


def installed_versions() -> dict[str, str | None]:
    """What this process runs with, by name, for reports and journals; None for a package that is not installed."""
    return {
        "protocol": str(PROTOCOL_VERSION),
        "python": platform.python_version(),
        **{package.name: _version(package.distribution) for package in PACKAGES if "report" in package.noted_in},
    }


def recorder_versions() -> dict[str, str]:
    """What a recorder runs with, by distribution, for the metadata of recordings."""
    return {each.distribution: version(each.distribution) for each in PACKAGES if "recording" in each.noted_in}


def _version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None
