"""Versions of the installed packages."""

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Final

from legpush.messages.common import PROTOCOL_VERSION

PACKAGES: Final = {
    "legpush": "legpush",
    "zenoh": "eclipse-zenoh",
    "mujoco": "mujoco",
    "ompl": "ompl",
    "numpy": "numpy",
    "scipy": "scipy",
    "msgpack": "msgpack",
    "msgspec": "msgspec",
    "matplotlib": "matplotlib",
}
"""Name in the report to name of the distribution."""


def installed_versions() -> dict[str, str | None]:
    """What this process runs with, by name; None for a package that is not installed."""
    return {
        "protocol": str(PROTOCOL_VERSION),
        "python": platform.python_version(),
        **{name: _version(distribution) for name, distribution in PACKAGES.items()},
    }


def _version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None
