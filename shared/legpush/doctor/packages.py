"""Checks the interpreter and the libraries, by what the installed package says that it needs."""

import platform
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, metadata, requires, version
from typing import Final

from packaging.requirements import Requirement

from legpush.doctor.finding import Finding

LEAST_PYTHON: Final = (3, 11)
FOR: Final = {
    "": "every command",
    "planner": "planning paths",
    "sim": "simulating and filming",
    "agent": "missions, evaluations and studies",
    "train": "training, and Gymnasium",
    "view": "`legpush view` and `legpush export`",
    "ray": "studies on Ray",
    "slurm": "studies on Slurm",
}
"""The extras, and what each is for; the empty name stands for what is always installed."""
NEEDED: Final = ("", "planner", "sim", "agent")
"""A mission needs these."""


def python_finding() -> Finding:
    """Return what the interpreter is."""
    detail = f"Python {platform.python_version()} on {platform.platform()}"
    if sys.version_info < LEAST_PYTHON:
        return Finding(name="python", state="missing", detail=detail, cure="install Python 3.11 or newer")
    return Finding(name="python", state="ok", detail=detail)


def package_findings() -> Iterator[Finding]:
    """Yield what is installed of each extra."""
    yield Finding(name="legpush", state="ok", detail=f"version {version('legpush')}")
    texts = requires("legpush") or ()
    extras = set(metadata("legpush").get_all("Provides-Extra") or ())
    told: set[str] = set()
    for extra, what in FOR.items():
        if extra and extra not in extras:
            continue
        there, wrong = _installed([Requirement(text) for text in texts], extra)
        name = f"[{extra}]" if extra else "libraries"
        if not wrong:
            yield Finding(name=name, state="ok", detail=f"{what}: {', '.join(sorted(set(there) - told))}")
            told |= set(there)
            continue
        yield Finding(
            name=name,
            state="missing" if extra in NEEDED else "note",
            detail=f"{what}: {', '.join(wrong)}",
            cure=f"pip install 'legpush[{extra}]'" if extra else "pip install legpush",
        )


def _installed(requirements: list[Requirement], extra: str) -> tuple[list[str], list[str]]:
    """Return what is installed of an extra with its versions, and what is not, or in a version that does not fit."""
    there: list[str] = []
    wrong: list[str] = []
    for each in requirements:
        if each.name == "legpush" or not _belongs(each, extra):
            continue
        try:
            found = version(each.name)
        except PackageNotFoundError:
            wrong.append(f"{each.name} is not installed")
            continue
        if each.specifier.contains(found, prereleases=True):
            there.append(f"{each.name} {found}")
        else:
            wrong.append(f"{each.name} {found} is installed, expected {each.specifier}")
    return there, wrong


def _belongs(requirement: Requirement, extra: str) -> bool:
    """Return whether a requirement is that of an extra, or without one, of the package itself."""
    if requirement.marker is None:
        return not extra
    with_extra, without = (requirement.marker.evaluate({"extra": name}) for name in (extra, ""))
    return without if not extra else with_extra and not without
