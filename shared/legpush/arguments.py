"""Parses command lines into typed options and back, and says how `--help` shows each argument."""

import types
from collections.abc import Iterator, Sequence
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from functools import cache, partial
from typing import Annotated, Any, Final, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import tyro
from tyro.constructors import (
    MISSING_NONPROP,
    ConstructorRegistry,
    PrimitiveConstructorSpec,
    PrimitiveTypeInfo,
    StructConstructorSpec,
    StructFieldSpec,
    StructTypeInfo,
)

NOT_SHOWN: Final = ("", "''", "None", "False")
"""Defaults that tell a reader nothing."""


def _shown_default(label: str) -> str:
    """Return what `--help` says about a default."""
    return "" if label in NOT_SHOWN else f"(default: {'yes' if label == 'True' else label})"


def arg(metavar: str | None = None, *, name: str | None = None, aliases: tuple[str, ...] | None = None) -> Any:
    """Describe an argument for `--help`: what its value is, such as `FILE`, and its name if the field has another.

    A default that says nothing, such as None or an empty list, is not shown.
    """
    return tyro.conf.arg(metavar=metavar, name=name, aliases=aliases, help_behavior_hint=_shown_default)


def subcommand(name: str, description: str | None = None) -> Any:
    """Describe one command of several."""
    return tyro.conf.subcommand(name, description=description)


T = TypeVar("T")

Flag = Annotated[bool, tyro.conf.FlagCreatePairsOff, arg()]
"""A switch that is off unless it is given."""
Switch = Annotated[bool, arg()]
"""A switch that is on unless its negation, `--no-...`, is given."""
Positional = Annotated[T, tyro.conf.Positional, arg()]
"""An argument without a flag."""
Repeated = Annotated[tuple[T, ...], tyro.conf.UseAppendAction]
"""An argument whose flag may be given several times, with one value each."""


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """What every command can be asked for."""

    json: Flag = False
    """Print the result as one JSON document on standard output. All else goes to standard error."""
    quiet: Annotated[bool, tyro.conf.FlagCreatePairsOff, arg(aliases=("-q",))] = False
    """Print nothing but errors, and with --json the document."""


USUAL_OUTPUT: Final = OutputOptions()
"""Lines for people, on standard output."""

_CONFIG: Final = (
    tyro.conf.OmitSubcommandPrefixes,
    tyro.conf.OmitArgPrefixes,
    tyro.conf.PositionalRequiredArgs,
    tyro.conf.DisallowNone,
)
_REGISTRY: Final = ConstructorRegistry()


@_REGISTRY.primitive_rule
def _choice_or_nothing(info: PrimitiveTypeInfo) -> PrimitiveConstructorSpec[Any] | None:
    """A choice that may be left out has its choices in their order, and no `None` among them."""
    kinds = [kind for kind in get_args(info.type) if kind is not types.NoneType]
    if info.type_origin not in (Union, types.UnionType) or len(kinds) != 1 or get_origin(kinds[0]) is not Literal:
        return None
    choices = tuple(map(str, get_args(kinds[0])))
    return PrimitiveConstructorSpec(
        nargs=1,
        metavar="{" + ",".join(choices) + "}",
        instance_from_str=lambda words: words[0],
        is_instance=lambda value: value is None or value in choices,
        str_from_instance=lambda value: [str(value)],
        choices=choices,
    )


@_REGISTRY.struct_rule
def _options(info: StructTypeInfo) -> StructConstructorSpec | None:
    """The fields of a dataclass, as tyro reads them, but for the line breaks of their docstrings, which it shows.

    A generic dataclass is one of tyro's own.
    """
    if not is_dataclass(info.type) or hasattr(info.type, "__parameters__"):
        return None
    kinds = get_type_hints(info.type, include_extras=True)
    return StructConstructorSpec(
        instantiate=info.type,
        fields=tuple(
            StructFieldSpec(
                field.name, kinds[field.name], _default(field, info.default), partial(_text, info.type, field.name)
            )
            for field in fields(info.type)
            if field.init
        ),
    )


def _default(field: Field[Any], instance: Any) -> Any:
    """Return the default of a field: that of an instance of the dataclass, if there is one, or its own."""
    if instance is tyro.MISSING:
        return instance
    if is_dataclass(instance):
        return getattr(instance, field.name)
    if field.default_factory is not MISSING:
        return field.default_factory()
    return MISSING_NONPROP if field.default is MISSING else field.default


def _text(kind: type, name: str) -> str | None:
    """Return the docstring of a field, with the line breaks between paragraphs alone."""
    text = _docstrings(kind).get(name)
    return None if text is None else "\n\n".join(" ".join(part.split()) for part in text.split("\n\n"))


@cache
def _docstrings(kind: type) -> dict[str, str | None]:
    """Return the docstrings of the fields of a dataclass by their names, those of its bases included."""
    from docstring_parser import parse_from_object

    owners = reversed(kind.__mro__[:-1])
    return {found.arg_name: found.description for owner in owners for found in parse_from_object(owner).params}


def parse(kind: Any, prog: str, argv: Sequence[str] | None = None, **more: Any) -> Any:
    """Return the options of a command line, of the type `kind`; without `argv`, that of this process.

    A wrong command line ends the process with exit code 2 and a text on standard error, and `--help` with 0. `prog` is
    the command as the user types it. `more` goes to `tyro.cli`.
    """
    return tyro.cli(kind, prog=prog, args=argv, config=_CONFIG, registry=_REGISTRY, **more)


def words(options: Any) -> list[str]:
    """Return the words of the command line that `parse` makes these options of; values by default are left out."""
    return [*_words(options, positional=True), *_words(options, positional=False)]


def _words(options: Any, *, positional: bool) -> Iterator[str]:
    """Yield the words of the arguments with a flag, or of those without."""
    kinds = get_type_hints(type(options), include_extras=True)
    for field in fields(options):
        if not field.init:
            continue
        value, marks = getattr(options, field.name), _marks(kinds[field.name])
        if is_dataclass(value):
            yield from _words(value, positional=positional)
        elif (tyro.conf.Positional in marks) == positional and value != _default(field, None):
            yield from _given(flag_of(field.name, marks), value, marks)


def _given(flag: str, value: Any, marks: tuple[Any, ...]) -> Iterator[str]:
    if isinstance(value, bool):
        yield flag if value else f"--no-{flag.removeprefix('--')}"
    elif tyro.conf.Positional in marks:
        yield from map(str, value if isinstance(value, tuple) else (value,))
    elif tyro.conf.UseAppendAction in marks:
        yield from (word for each in value for word in _with_value(flag, str(each)))
    elif isinstance(value, tuple):
        yield from (flag, *map(str, value))
    else:
        yield from _with_value(flag, str(value))


def _with_value(flag: str, value: str) -> tuple[str, ...]:
    """Return a flag with its value, which is no flag even if it begins like one."""
    return (f"{flag}={value}",) if value.startswith("-") else (flag, value)


def flag_of(name: str, marks: tuple[Any, ...]) -> str:
    """Return the flag of a field, which has another name if one is among the marks of its type."""
    named = next((each.name for each in marks if getattr(each, "name", None)), None)
    return f"--{(named or name).replace('_', '-')}"


def _marks(kind: Any) -> tuple[Any, ...]:
    """Return what a type is annotated with."""
    return getattr(kind, "__metadata__", ())
