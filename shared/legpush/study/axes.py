"""Axes: fields that vary, alone or together, and what a cell gets from them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Final

import msgspec
from msgspec import Meta, Struct

from legpush.errors import ConfigError
from legpush.study.cells import CellKind
from legpush.study.paths import require_path

RANGE: Final = {"first", "n"}
"""Keys of a table that is a range."""
MOST_VALUES: Final = 10_000_000
"""Most values of a range."""


class Range(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Equally spaced values, rising."""

    first: int | float
    n: Annotated[int, Meta(ge=1, le=MOST_VALUES)]
    step: Annotated[int, Meta(gt=0)] | Annotated[float, Meta(gt=0.0)] = 1

    def values(self) -> Sequence[Any]:
        """Return the values; whole numbers if first value and step are."""
        if isinstance(self.first, int) and isinstance(self.step, int):
            return range(self.first, self.first + self.n * self.step, self.step)
        return [self.first + index * self.step for index in range(self.n)]


@dataclass(frozen=True, kw_only=True)
class Axis:
    """Fields that vary together; alone, if it is one."""

    columns: Mapping[str, Sequence[Any]]
    """Values of each field, by its path; all of equal length."""
    n: int
    """Number of values."""

    def at(self, place: int) -> dict[str, Any]:
        """Return the values at a place."""
        return {path: values[place] for path, values in self.columns.items()}


def read_axes(
    axes: Mapping[str, Any],
    together: Sequence[Mapping[str, Any]],
    settings: Mapping[str, Any],
    kind: CellKind,
    where: str,
) -> tuple[Axis, ...]:
    """Read the axes of a study, in the order of its file.

    Raises:
        ConfigError: A field is unknown or given twice, a list is empty or has a value twice, or lists that belong
            together have different lengths.
    """
    groups = [(f"{where}: at axes", {path: values}) for path, values in _fields(axes).items()]
    groups += [(f"{where}: at together", _fields(table)) for table in together]
    seen = set(settings)
    for here, group in groups:
        for path in group:
            require_path(path, kind, here)
            if path in seen:
                raise ConfigError(f"{here}: expected each field once, got `{path}` twice")
            seen.add(path)
    return tuple(_axis(group, here) for here, group in groups)


def spread(values: Mapping[str, Any], kind: CellKind) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return values by path as nested tables of a specification, and the changes to another record among them."""
    own = set(kind.specification.__struct_fields__)
    plain: dict[str, Any] = {}
    changes: dict[str, Any] = {}
    for path, value in values.items():
        top, *rest = path.split(".")
        if top not in own:
            changes[path] = value
        elif rest:
            table = plain = {**plain, top: dict(plain.get(top) or {})}
            for name in (top, *rest[:-1]):
                table = table.setdefault(name, {})
            table[rest[-1]] = value
        else:
            plain[top] = value
    if kind.changes is not None:
        plain["changes"] = changes
    return plain, changes


def _fields(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the lists and ranges of a table by the path of their field."""
    found: dict[str, Any] = {}
    for name, value in table.items():
        if isinstance(value, Mapping) and value and not value.keys() >= RANGE:
            found |= {f"{name}.{below}": each for below, each in _fields(value).items()}
        else:
            found[name] = value
    return found


def _axis(group: Mapping[str, Any], where: str) -> Axis:
    columns = {path: _values(value, f"{where}: `{path}`") for path, value in group.items()}
    lengths = {path: len(values) for path, values in columns.items()}
    if not lengths:
        raise ConfigError(f"{where}: expected fields with lists of values, got an empty table")
    if len(set(lengths.values())) > 1:
        got = ", ".join(f"{path}: {n}" for path, n in lengths.items())
        raise ConfigError(f"{where}: expected lists of equal length, got {got}")
    if not any(isinstance(values, range) for values in columns.values()):
        seen: set[str] = set()
        for row in map(repr, zip(*columns.values(), strict=True)):
            if row in seen:
                raise ConfigError(f"{where}: expected different values of {', '.join(columns)}, got {row} twice")
            seen.add(row)
    return Axis(columns=columns, n=max(lengths.values()))


def _values(value: Any, where: str) -> Sequence[Any]:
    if isinstance(value, Mapping):
        try:
            return msgspec.convert(value, Range).values()
        except msgspec.ValidationError as error:
            raise ConfigError(f"{where}: expected a range such as {{first = 500, n = 20}} ({error})") from error
    if not isinstance(value, list) or not value:
        got = "an empty list" if value == [] else repr(value)
        raise ConfigError(f"{where}: expected a list of values, or a range such as {{first = 500, n = 20}}, got {got}")
    return value
