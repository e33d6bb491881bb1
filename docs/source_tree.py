"""Tables of the source tree for `architecture.md`, read from docstrings and from the import contracts."""

import ast
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).parents[1]
FOLDERS: Final[dict[str, Path]] = {
    "legpush": ROOT / "shared" / "legpush",
    "agent_proc": ROOT / "agent_proc",
    "planner_proc": ROOT / "planner_proc",
    "sim_proc": ROOT / "sim_proc",
}
"""The packages, in the order of the page."""
_END_OF_SENTENCE: Final = re.compile(r"(?<=[.!?])\s+(?=[A-Z`])")


@dataclass(frozen=True, kw_only=True)
class Part:
    """A folder or a top-level module of a package."""

    package: str
    name: str
    layer: int
    """1 is the lowest layer."""

    @property
    def path(self) -> Path:
        """The folder or the file."""
        folder = FOLDERS[self.package] / self.name
        return folder if folder.is_dir() else folder.with_suffix(".py")

    def what_it_is(self) -> str:
        """First sentence of its docstring."""
        return first_sentence(self.path / "__init__.py" if self.path.is_dir() else self.path)

    def libraries(self) -> list[str]:
        """Libraries that only some parts may import, this one among them."""
        return sorted(
            library
            for contract in _contracts("protected")
            for library in contract["protected_modules"]
            if any(_is_in(module, f"{self.package}.{self.name}") for module in contract["allowed_importers"])
        )


def parts(package: str) -> list[Part]:
    """Parts of a package, highest layer first."""
    (layers,) = (contract["layers"] for contract in _contracts("layers") if contract["containers"] == [package])
    return [
        Part(package=package, name=name.strip(), layer=layer)
        for layer, names in zip(range(len(layers), 0, -1), layers, strict=True)
        for name in names.split("|")
    ]


def package_table(package: str) -> str:
    """What a package is, a row for each part of it, and the imports that are forbidden besides."""
    lines = [first_sentence(FOLDERS[package] / "__init__.py"), ""]
    lines += ["| layer | part | what it is | libraries |", "| --- | --- | --- | --- |"]
    for part in parts(package):
        path = part.path.relative_to(ROOT).as_posix()
        name = f"{part.name}/" if part.path.is_dir() else part.path.name
        libraries = ", ".join(part.libraries())
        lines.append(f"| {part.layer} | [`{name}`](../{path}) | {part.what_it_is()} | {libraries} |")
    rules = list(_rules(package))
    return "\n".join([*lines, *([""] if rules else []), *rules, ""])


def _rules(package: str) -> Iterator[str]:
    """What the contracts forbid to single parts of this package."""
    for contract in _contracts("forbidden"):
        if all(module.startswith(f"{package}.") for module in contract["source_modules"]):
            yield _rule(contract, f"{package}.")


def shared_rules() -> str:
    """The contracts between whole packages."""
    lines = [f"- {contract['name']}: {_listed(contract['modules'], 'and')}." for contract in _contracts("independence")]
    lines += [
        _rule(contract, "")
        for contract in _contracts("forbidden")
        if all(source in FOLDERS for source in contract["source_modules"])
    ]
    return "\n".join([*lines, ""])


def _rule(contract: dict[str, Any], prefix: str) -> str:
    """A contract as a line of a list, its modules without the prefix of their package."""
    sources, targets = (
        [module.removeprefix(prefix) for module in contract[key]] for key in ("source_modules", "forbidden_modules")
    )
    return f"- {contract['name']}: {_listed(sources, 'and')} must not import {_listed(targets, 'or')}."


def first_sentence(module: Path) -> str:
    """First sentence of a module's docstring, in one line."""
    docstring = ast.get_docstring(ast.parse(module.read_text()))
    if docstring is None:
        raise ValueError(f"Expected a docstring in {module}, got none")
    return _END_OF_SENTENCE.split(" ".join(docstring.split()))[0].replace("|", "\\|")


@cache
def _import_linter() -> dict[str, Any]:
    project: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())
    found: dict[str, Any] = project["tool"]["importlinter"]
    return found


def _contracts(kind: str) -> list[dict[str, Any]]:
    return [contract for contract in _import_linter()["contracts"] if contract["type"] == kind]


def _is_in(module: str, part: str) -> bool:
    return f"{module}.".startswith(f"{part}.")


def _listed(names: list[str], last: str) -> str:
    quoted = [f"`{name}`" for name in names]
    return f" {last} ".join([", ".join(quoted[:-1]), quoted[-1]]) if len(quoted) > 1 else quoted[0]
