"""Explains a schema error in a file to its author: field, expectation, value, valid choices."""

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any, Final

import msgspec
from msgspec import inspect

from legpush.fields import range_of

LOCATED: Final = re.compile(r"\A(?P<what>.*) - at `\$\.?(?P<path>.*)`\Z", re.DOTALL)
_WORDS: Final = {
    "`object`": "a table",
    "`array`": "an array",
    "`float`": "a number",
    "`int`": "a whole number",
    "`str`": "a text",
    "`bool`": "a truth value",
}
"""Words for the types of a schema."""
_BEYOND: Final = re.compile(r"\AExpected `(int|float)` [<>]=? ")
"""A number out of its range."""
_FIELD_NAME: Final = re.compile(r"field `(?P<name>.*)`\Z", re.DOTALL)


def explain(
    error: str, plain: Any, kind: type[msgspec.Struct], *, at: str = "", also: Mapping[str, Sequence[str]] | None = None
) -> str:
    """Return the text of an error of `codec.convert(plain, kind)`, with the wrong value and the valid choices.

    `at` is the path of `plain` in its file. `also` lists fields that a table takes besides those of its record.
    """
    located = LOCATED.match(error)
    what, path = (located["what"], located["path"]) if located else (error, "")
    steps = re.findall(r"[^.\[\]]+", path)
    place = ".".join(filter(None, (at, path)))
    node, value = _node(kind, plain, steps), _value(plain, steps)
    if named := _FIELD_NAME.search(what):
        name = named["name"]
        valid = [*_field_names(node), *(also or {}).get(path, ())]
        place = ".".join(filter(None, (place, name)))
        if "unknown" not in what:
            tags = _tags(node) if isinstance(node, inspect.UnionType) else ()
            return f"at `{place}`: expected {' or '.join(tags) or 'a value'}, got nothing"
        nearest = get_close_matches(name, valid, n=1)
        hint = f" (did you mean `{nearest[0]}`?)" if nearest else ""
        return f"at `{place}`: unknown field{hint}; valid here: {', '.join(valid)}"
    if isinstance(node, inspect.UnionType) and (tags := _tags(node)):
        (tag_field,) = {one.tag_field for one in _records(node)}
        at_tag = bool(steps) and steps[-1] == tag_field
        what = (
            f"Expected one of {', '.join(tags)}"
            if at_tag
            else f"Expected a table with {tag_field} = {' or '.join(tags)}"
        )
    if (literal := _literal(node)) is not None:
        what = f"Expected one of {', '.join(map(str, literal.values))}"
    if _BEYOND.match(what) and (valid_range := _range(node)):
        what = f"Expected {'a whole number' if '`int`' in what else 'a number'} from {valid_range}"
    if isinstance(value, str | int | float) and not what.endswith(f"got {value}"):
        what += f" {value!r}" if ", got " in what else f", got {value!r}"
    for of_messages, of_files in _WORDS.items():
        what = what.replace(of_messages, of_files)
    return f"at `{place or 'the top'}`: {what[:1].lower()}{what[1:]}"


def _value(plain: Any, steps: Sequence[str]) -> Any:
    """Return the value at a path of keys and indices."""
    for step in steps:
        plain = plain[int(step)] if isinstance(plain, list) else plain[step]
    return plain


def _node(kind: type[msgspec.Struct], plain: Any, steps: Sequence[str]) -> inspect.Type:
    """Return the type at a path of keys and indices of a record; for a tag, the union that it chooses from."""
    node = _chosen(inspect.type_info(kind), plain)
    for step in steps:
        if isinstance(node, inspect.UnionType):
            return node
        if isinstance(node, inspect.StructType):
            node = next(field.type for field in node.fields if field.name == step)
        elif isinstance(node, inspect.TupleType):
            node = node.item_types[int(step)]
        elif isinstance(node, inspect.VarTupleType):
            node = node.item_type
        plain = _value(plain, [step])
        node = _chosen(node, plain)
    return node


def _chosen(node: inspect.Type, plain: Any) -> inspect.Type:
    """Return the record of a union that the value's tag names, or its only record; otherwise the type itself."""
    if isinstance(node, inspect.UnionType) and isinstance(plain, dict):
        for one in _records(node):
            if one.tag_field is None or plain.get(one.tag_field) == one.tag:
                return one
    return node


def _range(node: inspect.Type) -> str | None:
    """Return the range of a number that may be optional; None if it lacks a bound."""
    kinds = node.types if isinstance(node, inspect.UnionType) else (node,)
    return next(filter(None, map(range_of, kinds)), None)


def _records(node: inspect.UnionType) -> tuple[inspect.StructType, ...]:
    return tuple(one for one in node.types if isinstance(one, inspect.StructType))


def _literal(node: inspect.Type) -> inspect.LiteralType | None:
    """Return the choices of a field; also of one that may be absent."""
    types = node.types if isinstance(node, inspect.UnionType) else (node,)
    return next((one for one in types if isinstance(one, inspect.LiteralType)), None)


def _tags(node: inspect.UnionType) -> tuple[str, ...]:
    """Return the tags of the records of a union; empty if they have no tags."""
    return tuple(str(one.tag) for one in _records(node) if one.tag_field is not None)


def _field_names(node: inspect.Type) -> tuple[str, ...]:
    """Return the fields of a record, its tag first; empty for any other type."""
    if not isinstance(node, inspect.StructType):
        return ()
    tag = () if node.tag_field is None else (node.tag_field,)
    return (*tag, *(field.name for field in node.fields))
