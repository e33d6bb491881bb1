"""Versions of the installed packages, as reports, journals and recordings name them."""

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Final, NamedTuple

from legpush.messages.common import PROTOCOL_VERSION


class Package(NamedTuple):
    """A package whose version is noted somewhere."""

    distribution: str
    """Name of the distribution, by which recordings call it."""
    name: str
    """Name in reports and journals."""
    noted_in: frozenset[str]
    """`report` (of a mission, and its journal), `recording`, or both."""


REPORT: Final = frozenset({"report"})
RECORDING: Final = frozenset({"recording"})

PACKAGES: Final = (
    Package("legpush", "legpush", REPORT | RECORDING),
    Package("eclipse-zenoh", "zenoh", REPORT | RECORDING),
    Package("mcap", "mcap", RECORDING),
    Package("mujoco", "mujoco", REPORT),
    Package("ompl", "ompl", REPORT),
    Package("numpy", "numpy", REPORT),
    Package("scipy", "scipy", REPORT),
    Package("msgpack", "msgpack", REPORT | RECORDING),
    Package("msgspec", "msgspec", REPORT | RECORDING),
    Package("matplotlib", "matplotlib", REPORT),
)
"""A recorder needs few of them; what a mission computes depends on the rest."""


def installed_versions() -> dict[str, str | None]:
    """What this process runs with, by name, for reports and journals; None for a package that is not installed."""
    return {
        "protocol": str(PROTOCOL_VERSION),
        "python": platform.python_version(),
        **{package.name: _version(package.distribution) for package in PACKAGES if REPORT <= package.noted_in},
    }


def recorder_versions() -> dict[str, str]:
    """What a recorder runs with, by distribution, for the metadata of recordings."""
    return {each.distribution: version(each.distribution) for each in PACKAGES if RECORDING <= each.noted_in}


def _version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None
