"""The public names of the package `legpush`, as directives that Sphinx fills from the docstrings, in `api.md`."""

import inspect
from typing import Final

import msgspec

import legpush

TITLES: Final = (
    ("Missions and worlds", lambda value: callable(value) and not isinstance(value, type)),
    ("Errors", lambda value: isinstance(value, type) and issubclass(value, Exception)),
    ("Records", lambda value: isinstance(value, type) and issubclass(value, msgspec.Struct)),
    ("Other classes", inspect.isclass),
)
"""Headings in their order, each with what it takes of what no heading before it has taken."""


def public_names() -> str:
    """Return the page's part: a heading for each kind of name, and a directive for each name."""
    left = [name for name in legpush.__all__ if not name.startswith("_")]
    parts: list[str] = []
    for title, takes in TITLES:
        taken = [name for name in left if takes(getattr(legpush, name))]
        left = [name for name in left if name not in taken]
        parts += [f"## {title}", "", "```{eval-rst}"]
        for name in taken:
            value = getattr(legpush, name)
            kind = "autoclass" if inspect.isclass(value) else "autofunction"
            parts += [f".. {kind}:: legpush.{name}{_short_signature(value)}", ""]
        parts += ["```", ""]
    if left:
        raise RuntimeError(f"Expected a heading for every public name, got none for {', '.join(left)}")
    return "\n".join(parts)


def _short_signature(value: object) -> str:
    """Return a signature without values for a record of records, whose own one fills a page."""
    if not (isinstance(value, type) and issubclass(value, msgspec.Struct)):
        return ""
    fields = msgspec.structs.fields(value)
    return "(**fields)" if any(isinstance(field.default, msgspec.Struct) for field in fields) else ""
