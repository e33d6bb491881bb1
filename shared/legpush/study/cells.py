"""Kinds of cells: what a cell takes, how it is made self-contained, and what it returns."""

import inspect
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, get_type_hints

import msgspec
from msgspec import Struct

from legpush.errors import ConfigError, LegpushError, PluginError
from legpush.plugins import Group, load_address, load_plugin, plugin_names

GROUP: Final[Group] = "legpush.cells"
"""Entry points of kinds of cells."""


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of results."""

    name: str
    unit: str
    """Empty for a column without a unit."""
    about: str
    may_differ: bool = False
    """Whether it may differ when the cell is run again, as seconds do."""


Resolve = Callable[[Any, Collection[str]], Struct]
"""Makes a specification self-contained; the second argument has the policies with code that the user allows."""


@dataclass(frozen=True, kw_only=True)
class CellKind:
    """A kind of cell: a pure function from a specification to columns."""

    specification: type[Struct]
    """What a study file sets."""
    run: Callable[[Any], Mapping[str, Any]]
    """Runs a resolved specification in this process; returns numbers, truth values, texts, and lists of these."""
    resolved: type[Struct]
    """The type of resolved specifications: equal ones always mean the same work."""
    resolve: Resolve
    """Makes a resolved specification; raises a `LegpushError` for one that cannot be run."""
    run_in: Callable[[Any, Path], Mapping[str, Any]] | None = None
    """Runs it in a folder that it keeps its work in: it goes on there after an interruption, to the same results as
    `run`. None if cells of this kind keep no work."""
    columns: tuple[Column, ...] = ()
    """The result columns; empty if they are not known before."""
    changes: type[Struct] | None = None
    """Dotted fields of this record, such as `box.mass_kg`, may be set too; they go to the field `changes`."""
    needs_canary: bool = True
    """Whether its results depend on the arithmetic of the processor, so that a worker must show its canary."""


def load_kind(name: str) -> CellKind:
    """Return the kind of cell with this name, or the one at `module:function`.

    A function is a kind too: its parameters are the specification, and it returns the columns.

    Raises:
        PluginError: There is no such plug-in, or it cannot be imported.
        ConfigError: The address has no kind of cell.
    """
    if ":" not in name:
        return _as_kind(load_plugin(GROUP, name), name)
    try:
        found = load_address(name, "module:function that can be imported for the cell")
    except PluginError as error:
        raise ConfigError(str(error)) from error
    return _as_kind(found, name)


def kind_names() -> tuple[str, ...]:
    """Return the names of the installed kinds of cells, sorted."""
    return plugin_names(GROUP)


def _as_kind(found: object, name: str) -> CellKind:
    if isinstance(found, CellKind):
        return found
    if inspect.isfunction(found):
        return _of_function(found, name)
    raise ConfigError(f"Expected a CellKind or a function at {name}, got {type(found).__name__}")


def _of_function(function: Callable[..., Mapping[str, Any]], name: str) -> CellKind:
    """Make a kind of a function whose parameters have types and can be given by name."""
    hints = get_type_hints(function, include_extras=True)
    fields: list[tuple[str, Any, Any]] = []
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind not in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY):
            raise ConfigError(f"{name}: expected parameters that can be given by name, got {parameter}")
        if parameter.name not in hints:
            raise ConfigError(f"{name}: expected a type for each parameter, got none for {parameter.name}")
        default = msgspec.NODEFAULT if parameter.default is parameter.empty else parameter.default
        fields.append((parameter.name, hints[parameter.name], default))
    record = msgspec.defstruct("Cell", fields, frozen=True, kw_only=True, forbid_unknown_fields=True)

    def run(specification: Struct) -> Mapping[str, Any]:
        return function(**msgspec.structs.asdict(specification))

    return CellKind(specification=record, run=run, resolved=record, resolve=as_it_is)


def as_it_is(specification: Struct, _: Collection[str]) -> Struct:
    """Resolve a specification that is self-contained already."""
    return specification


def columns_of(kind: CellKind, resolved: Struct, folder: Path | None = None) -> dict[str, Any]:
    """Run a cell and return its columns; with a folder, it keeps its work there if its kind can.

    Raises:
        CellError: It does not return columns of numbers, truth values, texts and lists of these.
    """
    columns = kind.run(resolved) if folder is None or kind.run_in is None else kind.run_in(resolved, folder)
    if not isinstance(columns, Mapping) or not all(isinstance(name, str) for name in columns):
        raise CellError(f"Expected a dictionary of columns, got {type(columns).__name__}")
    return {name: _plain(value, name) for name, value in columns.items()}


class CellError(LegpushError):
    """A cell that returns something else than columns."""


def _plain(value: Any, name: str) -> Any:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(each, name) for each in value]
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise CellError(f"Expected a number, a truth value, a text or a list as {name}, got {type(value).__name__}")
