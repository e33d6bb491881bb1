"""What the tests of the project's own files share: its root, what it declares, and what that pulls in."""

import tomllib
from collections.abc import Iterable, Iterator
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]


class Declarations:
    """The requirements that `pyproject.toml` declares, and everything installed that they lead to."""

    def __init__(self, pyproject: dict[str, Any]) -> None:
        project = pyproject["project"]
        self._name: str = project["name"]
        self._base: list[str] = project["dependencies"]
        self._extras: dict[str, list[str]] = project["optional-dependencies"]
        self._groups: dict[str, list[str | dict[str, str]]] = pyproject["dependency-groups"]

    def direct(self, *extras: str) -> list[Requirement]:
        """The base requirements and those of `extras`, with references to own extras resolved.

        The name of a group of dependencies stands for a host that has nothing but these.
        """
        base = [] if self._groups.keys() & set(extras) else list(self._resolved(self._base))
        return base + [
            requirement
            for extra in extras
            for requirement in (self.of_group(extra) if extra in self._groups else self._resolved(self._extras[extra]))
        ]

    def of_group(self, name: str) -> list[Requirement]:
        """What the host for one process needs."""
        found: list[Requirement] = []
        for each in self._groups[name]:
            found += [Requirement(each)] if isinstance(each, str) else self.of_group(each["include-group"])
        return found

    def _resolved(self, lines: Iterable[str]) -> Iterator[Requirement]:
        for requirement in map(Requirement, lines):
            if requirement.name == self._name:
                for extra in requirement.extras:
                    yield from self._resolved(self._extras[extra])
            else:
                yield requirement

    def needed(self, *extras: str) -> set[str]:
        """Canonical names of all distributions that `legpush[extras]` installs in this environment."""
        found: set[tuple[str, str]] = set()
        waiting = self.direct(*extras)
        while waiting:
            requirement = waiting.pop()
            for extra in ("", *requirement.extras):
                if requirement.marker is not None and not requirement.marker.evaluate({"extra": extra}):
                    continue
                key = (canonicalize_name(requirement.name), extra)
                if key not in found:
                    found.add(key)
                    waiting += _requirements_of(requirement.name, extra)
        return {name for name, _ in found}


def _requirements_of(name: str, extra: str) -> Iterator[Requirement]:
    """What the installed distribution `name[extra]` requires here."""
    for requirement in map(Requirement, distribution(name).requires or ()):
        if requirement.marker is None or requirement.marker.evaluate({"extra": extra}):
            requirement.marker = None
            yield requirement


@pytest.fixture(scope="session")
def root() -> Path:
    """The root of the checkout."""
    return ROOT


@pytest.fixture(scope="session")
def pyproject(root: Path) -> dict[str, Any]:
    """The parsed `pyproject.toml`."""
    return tomllib.loads((root / "pyproject.toml").read_text())


@pytest.fixture(scope="session")
def declarations(pyproject: dict[str, Any]) -> Declarations:
    """The declared requirements."""
    return Declarations(pyproject)
