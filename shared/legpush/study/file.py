"""Reads study files: which kind of cell, which settings, and which axes."""

import tomllib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import prod
from pathlib import Path
from typing import Any, Final

import msgspec
from msgspec import Struct

from legpush.errors import ConfigError, LegpushError
from legpush.fields import Name
from legpush.schema_errors import explain
from legpush.study.axes import Axis, read_axes, spread
from legpush.study.cells import CellKind, kind_names, load_kind
from legpush.study.identity import cell_identity, code_version
from legpush.study.jobs import Task
from legpush.study.paths import flattened, require_path

CHANGES: Final = "changes"
"""The field of a specification that has its dotted fields of another record, such as the scenario."""
MANY_CELLS: Final = 1_000_000
"""A study with more cells has to be asked for once more."""


class StudyFile(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The content of a study file."""

    name: Name
    cell: str | None = None
    """The kind of cell."""
    settings: dict[str, Any] = {}
    """Fields of its specification with one value for all cells."""
    axes: dict[str, Any] = {}
    """Fields with a list of values, or with a range such as `{first = 500, n = 20}`; cells are all combinations."""
    together: tuple[dict[str, Any], ...] = ()
    """Fields that vary together: lists of equal length, of which each cell has the values at one place."""
    results: tuple[str, ...] | None = None
    """Result columns to keep; without it, all are kept."""


@dataclass(frozen=True, kw_only=True)
class Study:
    """A study: its kind of cell, and every cell by its index. Cells are made when they are asked for."""

    source: str
    """The text of the file."""
    where: str
    """Its name in messages."""
    file: StudyFile
    kind_name: str
    kind: CellKind
    settings: Mapping[str, Any]
    """By the path of the field."""
    axes: tuple[Axis, ...]
    allowed_policies: Collection[str]
    """Policies that run code and were named on the command line."""

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return prod(axis.n for axis in self.axes)

    @cached_property
    def code(self) -> str:
        """The code version of this process."""
        return code_version(self.kind_name)

    def values(self, index: int) -> dict[str, Any]:
        """Return the values of the axes in a cell, by the path of the field; the first axis varies slowest."""
        found: dict[str, Any] = {}
        for axis in reversed(self.axes):
            index, place = divmod(index, axis.n)
            found = {**axis.at(place), **found}
        return found

    def task(self, index: int) -> Task:
        """Return a cell with its identity, its inputs and its resolved specification.

        Raises:
            ConfigError: A value cannot be used; names the file and the field.
        """
        values = self.values(index)
        plain, changes = spread({**self.settings, **values}, self.kind)
        try:
            specification = msgspec.convert(plain, self.kind.specification)
            resolved = self.kind.resolve(specification, self.allowed_policies)
        except msgspec.ValidationError as error:
            raise ConfigError(f"{self.where}: {explain(str(error), plain, self.kind.specification)}") from error
        except LegpushError as error:
            here = ", ".join(f"{path} = {value!r}" for path, value in values.items())
            raise ConfigError(f"{self.where}: {f'in the cell {here}: ' if here else ''}{error}") from error
        inputs = msgspec.to_builtins(specification)
        inputs.pop(CHANGES, None)
        record = msgspec.to_builtins(resolved)
        return Task(
            cell=cell_identity(self.kind_name, record, self.code),
            inputs={path: _column(value) for path, value in {**flattened(inputs), **changes}.items()},
            specification=record,
        )

    def tasks(self) -> Iterator[Task]:
        """Yield every cell."""
        return map(self.task, range(self.n_cells))


def load_study(
    path: Path, *, own_cell: str | None = None, allowed_policies: Collection[str] = (), many: bool = False
) -> Study:
    """Read a study file and check every field and axis.

    `own_cell` is the `module:function` of a kind of cell that was named on the command line: a file alone cannot name
    code. With `many`, it may have more than a million cells.

    Raises:
        ConfigError: The file cannot be used; names the file, the field and the valid choices.
        PluginError: The kind of cell is not installed.
    """
    try:
        source = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigError(f"{path}: expected a readable study file ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: expected a readable study file ({error})") from error
    return read_study(source, str(path), own_cell=own_cell, allowed_policies=allowed_policies, many=many)


def read_study(
    source: str,
    where: str,
    *,
    own_cell: str | None = None,
    allowed_policies: Collection[str] = (),
    many: bool = False,
) -> Study:
    """Read the text of a study file; see `load_study`."""
    try:
        plain = tomllib.loads(source)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{where}: expected TOML ({error})") from error
    try:
        file = msgspec.convert(plain, StudyFile)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{where}: {explain(str(error), plain, StudyFile)}") from error
    name = _kind_name(file, own_cell, where)
    kind = load_kind(name)
    if file.results is not None and kind.columns:
        _require_results(file.results, kind, where)
    settings = flattened(file.settings, kind)
    for field in settings:
        require_path(field, kind, f"{where}: at settings")
    axes = read_axes(file.axes, file.together, settings, kind, where)
    study = Study(
        source=source,
        where=where,
        file=file,
        kind_name=name,
        kind=kind,
        settings=settings,
        axes=axes,
        allowed_policies=allowed_policies,
    )
    if study.n_cells > MANY_CELLS and not many:
        raise ConfigError(f"{where}: expected at most {MANY_CELLS} cells, got {study.n_cells}; --yes runs them all")
    return study


def _column(value: Any) -> Any:
    """Return a value as a column: tables, such as obstacles or a reference, as JSON."""
    has_tables = isinstance(value, Mapping) or (isinstance(value, list) and any(isinstance(v, Mapping) for v in value))
    return msgspec.json.encode(value).decode() if has_tables else value


def _kind_name(file: StudyFile, own_cell: str | None, where: str) -> str:
    """Return the kind of cell; code is named by the command line only."""
    if own_cell is not None and ":" not in own_cell:
        raise ConfigError(f"Expected module:function for --cell, got {own_cell!r}; a file names an installed kind")
    if file.cell is None or ":" in file.cell:
        if own_cell is None:
            got = "no cell" if file.cell is None else f"{file.cell}, which runs code"
            remedy = "--cell module:function" if file.cell is None else f"--cell {file.cell} if you trust it"
            raise ConfigError(f"{where}: at `cell`: expected one of {', '.join(kind_names())}, got {got}: {remedy}")
        if file.cell is not None and file.cell != own_cell:
            raise ConfigError(f"{where}: at `cell`: expected {own_cell}, as --cell says, got {file.cell}")
        return own_cell
    if own_cell is not None:
        raise ConfigError(f"{where}: at `cell`: expected {own_cell} or none with --cell, got {file.cell}")
    if file.cell not in kind_names():
        raise ConfigError(f"{where}: at `cell`: expected one of {', '.join(kind_names())}, got {file.cell!r}")
    return file.cell


def _require_results(results: Collection[str], kind: CellKind, where: str) -> None:
    valid = [column.name for column in kind.columns]
    if not results or (unknown := [name for name in results if name not in valid]):
        got = ", ".join(unknown) if results else "an empty list"
        raise ConfigError(f"{where}: at `results`: expected columns among {', '.join(valid)}, got {got}")
