"""Paths of fields, such as `seed`, `random_room.obstacles` or `box.mass_kg`, checked against records."""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any, Final

from msgspec import inspect

from legpush.errors import ConfigError
from legpush.study.cells import CellKind

_RECORDS: Final = (inspect.StructType, inspect.DataclassType)
_Record = inspect.StructType | inspect.DataclassType


def require_path(path: str, kind: CellKind, where: str) -> None:
    """Check that a field exists in the specification of a kind of cell, or in the record that it changes.

    Raises:
        ConfigError: It does not; lists the valid ones.
    """
    own = _fields(_root(kind.specification))
    valid = [name for name in own if name != "changes" or kind.changes is None]
    top = path.split(".")[0]
    if top in valid:
        node: inspect.Type = _root(kind.specification)
    elif kind.changes is not None and top in _fields(_root(kind.changes)):
        node = _root(kind.changes)
    else:
        also = "" if kind.changes is None else _dotted(kind.changes)
        raise _unknown(path, path, valid, where, also)
    done: list[str] = []
    for name in path.split("."):
        fields = {} if (record := _record(node)) is None else {field.name: field.type for field in record.fields}
        if name not in fields:
            raise _unknown(path, name, list(fields), where, f", in {'.'.join(done)}")
        done.append(name)
        node = fields[name]


def flattened(table: Mapping[str, Any], kind: CellKind | None = None) -> dict[str, Any]:
    """Return a table of tables as paths of fields and their values.

    With `kind`, a table that is the value of a field, such as a reference curve, stays a value.
    """
    found: dict[str, Any] = {}
    for name, value in table.items():
        if isinstance(value, Mapping) and value and (kind is None or _is_table(name, kind)):
            found |= _below(name, value, kind)
        else:
            found[name] = value
    return found


def _below(path: str, table: Mapping[str, Any], kind: CellKind | None) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in table.items():
        here = f"{path}.{name}"
        if isinstance(value, Mapping) and value and (kind is None or _is_table(here, kind)):
            found |= _below(here, value, kind)
        else:
            found[here] = value
    return found


def _is_table(path: str, kind: CellKind) -> bool:
    """Whether the field at a path is a record in every case, or unknown, so that its table is one of fields."""
    for root in filter(None, (kind.specification, kind.changes)):
        node: inspect.Type | None = _root(root)
        for name in path.split("."):
            record = node if isinstance(node, _RECORDS) else None
            node = None if record is None else next((f.type for f in record.fields if f.name == name), None)
        if node is not None:
            return isinstance(node, _RECORDS)
    return True


def _root(record: type) -> inspect.Type:
    return inspect.type_info(record)


def _record(node: inspect.Type) -> _Record | None:
    """Return the record that a field has, or may have."""
    if isinstance(node, inspect.UnionType):
        return next((one for one in node.types if isinstance(one, _RECORDS)), None)
    return node if isinstance(node, _RECORDS) else None


def _fields(node: inspect.Type) -> list[str]:
    record = _record(node)
    return [] if record is None else [field.name for field in record.fields]


def _dotted(record: type) -> str:
    return f", or a field of the {record.__name__.lower()} ({', '.join(_fields(_root(record)))})"


def _unknown(path: str, name: str, valid: list[str], where: str, also: str) -> ConfigError:
    nearest = get_close_matches(name, valid, n=1)
    hint = f" (did you mean `{nearest[0]}`?)" if nearest else ""
    choices = ", ".join(valid) or "nothing"
    return ConfigError(f"{where}: unknown field `{path}`{hint}; valid here: {choices}{also}")
