"""Tables of all commands and their options in `commands.md`, from the texts of `--help`."""

import io
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass, field
from typing import Final

from legpush.cli import command as cli
from legpush.cli.commands import COMMANDS, Group

WIDTH: Final = "120"
USUAL: Final = "output options"
"""Options that every command has; they stand once, at the top."""
HELP: Final = "-h, --help"
_TITLE: Final = re.compile(r"^ \S")
_DASHES: Final = re.compile(r"^ -+$")
_ROW: Final = re.compile(r"^  (?P<name>\S+( \S+)*)\s{2,}(?P<text>\S.*)$")
_NAME: Final = re.compile(r"^  (?P<name>-{1,2}[a-z]\S*( \S+)*)$")
_INDENT: Final = " " * 10
"""At least this much is before the lines of a text that goes on."""


@dataclass
class Help:
    """The text of `--help` of a command, taken apart."""

    usage: str
    what: str
    """Its description, in one line."""
    boxes: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    """Title of each box, and the arguments in it with their texts."""


def command_names() -> Iterator[str]:
    """Yield the words behind `legpush` of every command that does something, such as `study verify`."""
    for name, options in COMMANDS.items():
        if isinstance(options, Group):
            yield from (f"{name} {below}" for below in options.commands)
        else:
            yield name


def command_tables() -> str:
    """Return the page's part: what all commands have in common, then each command."""
    helps = {name: read_help(help_text(name)) for name in command_names()}
    usual = next(help_.boxes[USUAL] for help_ in helps.values() if USUAL in help_.boxes)
    parts = ["## All commands", "", *_table(usual)]
    for name, help_ in helps.items():
        parts += [f"## legpush {name}", "", f"`{help_.usage}`", "", help_.what, ""]
        rows = [row for title, box in help_.boxes.items() if title != USUAL for row in box if row[0] != HELP]
        parts += _table(rows) if rows else []
    return "\n".join(parts)


def help_text(name: str) -> str:
    """Return what `legpush NAME --help` prints on a terminal of `WIDTH` columns.

    Raises:
        RuntimeError: It ends with an exit code other than 0.
    """
    out = io.StringIO()
    with _environment(COLUMNS=WIDTH, NO_COLOR="1"), redirect_stdout(out):
        try:
            code: object = cli.main([*name.split(), "--help"])
        except SystemExit as end:
            code = end.code
    if code:
        raise RuntimeError(f"Expected exit code 0 of `legpush {name} --help`, got {code}")
    return out.getvalue()


def read_help(text: str) -> Help:
    """Take the text of `--help` apart."""
    lines = [line.rstrip() for line in text.splitlines()]
    first = next(n for n in range(len(lines)) if _is_title(lines, n))
    usage, _, what = "\n".join(lines[:first]).partition("\n\n")
    found = Help(_flat(usage.removeprefix("usage:")), _flat(what))
    box: list[tuple[str, str]] = []
    for n in range(first, len(lines)):
        if _is_title(lines, n):
            box = found.boxes.setdefault(lines[n].strip(), [])
        elif row := _ROW.match(lines[n]):
            box.append((row["name"], row["text"]))
        elif alone := _NAME.match(lines[n]):
            box.append((alone["name"], ""))
        elif lines[n].startswith(_INDENT) and box:
            box[-1] = box[-1][0], f"{box[-1][1]} {lines[n].strip()}".strip()
    return found


def _is_title(lines: Sequence[str], n: int) -> bool:
    """Whether a line is the title of a box: a line of dashes follows."""
    return bool(_TITLE.match(lines[n]) and n + 1 < len(lines) and _DASHES.match(lines[n + 1]))


def _table(rows: list[tuple[str, str]]) -> list[str]:
    # Choices may be broken into lines.
    cells = [(f"`{name.replace(',', ', ').replace(',  ', ', ')}`", _flat(text)) for name, text in rows]
    cells = [(name.replace("|", "\\|"), text.replace("|", "\\|")) for name, text in cells]
    return ["| argument | meaning |", "| --- | --- |", *(f"| {name} | {text} |" for name, text in cells), ""]


def _flat(text: str) -> str:
    return " ".join(text.split())


@contextmanager
def _environment(**variables: str) -> Iterator[None]:
    before: Mapping[str, str] = dict(os.environ)
    os.environ.update(variables)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)
