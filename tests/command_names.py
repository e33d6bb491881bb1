"""The commands of legpush, as their options define them."""

from collections.abc import Iterator
from typing import Any, get_args, get_type_hints

from legpush.cli.command import Command


def command_names() -> Iterator[str]:
    """The words behind `legpush` of every command, such as `study` and `study verify`."""
    for name, options in _subcommands(Command):
        yield name
        for below, _ in _subcommands(get_type_hints(options, include_extras=True).get("action")):
            yield f"{name} {below}"


def leaf_names() -> list[str]:
    """The same without those that have commands below them."""
    names = list(command_names())
    return [name for name in names if not any(other.startswith(f"{name} ") for other in names)]


def _subcommands(union: Any) -> Iterator[tuple[str, Any]]:
    """Name and options of each command of a union; none if it is another type."""
    for kind in get_args(union):
        for mark in getattr(kind, "__metadata__", ()):
            if (name := getattr(mark, "name", None)) is not None:
                yield name, kind.__origin__
