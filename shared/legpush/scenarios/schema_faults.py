"""Finds all schema errors of a file at once, where a conversion to its record stops at the first one."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

import msgspec

from legpush.errors import MessageError
from legpush.schema_errors import LOCATED, explain

Convert = Callable[[Any, Any], Any]
"""Makes a record of plain values, or raises a `MessageError` that names the first wrong one."""


def schema_faults(
    plain: Any, kind: type[msgspec.Struct], convert: Convert, *, also: Mapping[str, Sequence[str]] | None = None
) -> list[str]:
    """Return the texts of all errors of `convert(plain, kind)`, each as `explain` words it; empty if there is none.

    A check of a whole table is made once all its fields are right.
    """
    return [explain(error, plain, kind, also=also) for error in dict.fromkeys(_errors(plain, kind, convert, ""))]


def _errors(plain: Any, kind: Any, convert: Convert, path: str) -> Iterator[str]:
    """Yield the errors of a value, each with its path from the top."""
    try:
        convert(plain, kind)
    except MessageError as error:
        inner = [*_names(plain, kind, path)]
        for part, part_kind, part_path in _parts(plain, kind, path):
            inner += _errors(part, part_kind, convert, part_path)
        if not inner or not LOCATED.match(str(error)):
            # The fault is that of the value as a whole, such as the length of an array, whatever its parts are.
            inner.insert(0, _moved(str(error), path))
        yield from inner


def _names(plain: Any, kind: Any, path: str) -> Iterator[str]:
    """Yield the errors of the names of a table: unknown ones, and those that are missing."""
    record = _record(plain, kind)
    if record is None:
        return
    fields = msgspec.structs.fields(record)
    known = {field.encode_name for field in fields} | {record.__struct_config__.tag_field}
    for name in plain:
        if name not in known and record.__struct_config__.forbid_unknown_fields:
            yield _moved(f"Object contains unknown field `{name}`", path)
    for field in fields:
        if field.required and field.encode_name not in plain:
            yield _moved(f"Object missing required field `{field.encode_name}`", path)


def _parts(plain: Any, kind: Any, path: str) -> Iterator[tuple[Any, Any, str]]:
    """Yield what a value is made of: each part with its type and its path."""
    record = _record(plain, kind)
    if record is not None:
        for name, field_kind in get_type_hints(record, include_extras=True).items():
            if name in plain:
                yield plain[name], field_kind, f"{path}.{name}" if path else name
    for one in _alternatives(kind):
        kinds = get_args(one)
        if get_origin(one) is not tuple or not isinstance(plain, list):
            continue
        if kinds[1:] == (...,):
            kinds = kinds[:1] * len(plain)
        if len(kinds) == len(plain):
            for index, (part, part_kind) in enumerate(zip(plain, kinds, strict=True)):
                yield part, part_kind, f"{path}[{index}]"


def _record(plain: Any, kind: Any) -> type[msgspec.Struct] | None:
    """Return the record that a table should be: the only one of its type, or the one that its tag names."""
    if not isinstance(plain, dict):
        return None
    records = [one for one in _alternatives(kind) if isinstance(one, type) and issubclass(one, msgspec.Struct)]
    for one in records:
        config = one.__struct_config__
        if config.tag_field is None or plain.get(config.tag_field) == config.tag:
            return one
    return None


def _alternatives(kind: Any) -> tuple[Any, ...]:
    """Return the types that a value may have, without what is annotated about them."""
    if get_origin(kind) is Annotated:
        return _alternatives(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return tuple(one for part in get_args(kind) for one in _alternatives(part))
    return (kind,)


def _moved(error: str, path: str) -> str:
    """Return the text of an error with the path from the top."""
    located = LOCATED.match(error)
    what, inner = (located["what"], located["path"]) if located else (error, "")
    whole = f"{path}{inner}" if not path or inner.startswith("[") or not inner else f"{path}.{inner}"
    return f"{what} - at `$.{whole}`" if whole else what
