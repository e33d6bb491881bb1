"""The texts below fields and constants, from their source."""

import ast
import inspect
from collections.abc import Iterator, Sequence
from textwrap import dedent
from typing import Any

import msgspec


def field_texts(record: type[msgspec.Struct]) -> Iterator[tuple[str, str]]:
    """The text below each field of the class and of the records that it is derived from."""
    for base in reversed(record.__mro__):
        if base.__module__.startswith("legpush."):
            (definition,) = tree_of(base).body
            if not isinstance(definition, ast.ClassDef):
                raise TypeError(f"Expected a class, got {base}")
            yield from ((names[-1], text) for names, text in texts_below(definition.body))


def tree_of(source: Any) -> ast.Module:
    """The syntax tree of a module or class."""
    return ast.parse(dedent(inspect.getsource(source)))


def texts_below(body: Sequence[ast.stmt]) -> Iterator[tuple[tuple[str, ...], str]]:
    """Each text below annotated assignments, with the names that are assigned without a text in between."""
    names: tuple[str, ...] = ()
    for node in body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names = (*names, node.target.id)
            continue
        text = node.value.value if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) else None
        if names and isinstance(text, str):
            yield names, flat(text)
        names = ()


def flat(text: str) -> str:
    """A text as one line of a table."""
    return " ".join(text.split()).replace("|", "\\|")
