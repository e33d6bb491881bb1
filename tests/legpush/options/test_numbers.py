"""Numbers on command lines: no command takes one that it cannot use, and it starts nothing."""

import types
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Final, Union, get_args, get_origin, get_type_hints

import pytest

from legpush.cli import command as cli
from legpush.cli.commands import all_commands

NEEDED: Final[dict[str, list[str]]] = {
    "evaluate": ["scripted"],
    "compare": ["scripted"],
    "curves": ["training"],
    "scenarios random": ["new.toml"],
    "map": ["map.csv", "--first-row", "top"],
    "record": ["new.mcap"],
    "replay": ["old.mcap"],
    "branch": ["old.mcap", "--at", "0:1"],
    "study run": ["study.toml"],
    "study verify": ["study"],
    "export": ["old.mcap", "--to", "mp4"],
    "secure init": ["new"],
    "secure add": ["lab", "robot"],
    "secure renew": ["lab"],
    "health": ["sim"],
}
"""What a command needs besides the number."""
AFTER: Final[dict[str, list[str]]] = {"plan-check": ["--", "sh"]}
"""The same, after the number."""
WRONG: Final = ("-1", "nan", "inf", "1e308", "1" + 308 * "0")


def numeric_flags(options: type) -> Iterator[tuple[str, int]]:
    """The flags that take numbers, each with how many."""
    hints = get_type_hints(options, include_extras=True)
    for field in fields(options):
        kind, name = hints[field.name], field.name
        while get_origin(kind) is Annotated:
            kind, *about = get_args(kind)
            name = next(filter(None, (getattr(each, "name", None) for each in about)), name)
        variants = get_args(kind) if get_origin(kind) in (Union, types.UnionType) else (kind,)
        for variant in variants:
            items = get_args(variant) if get_origin(variant) is tuple else (variant,)
            if items[0] in (int, float):
                yield f"--{name.replace('_', '-')}", len([item for item in items if item is not Ellipsis])


FLAGS = [(command, *flag) for command, options in all_commands().items() for flag in numeric_flags(options)]


def test_the_options_with_numbers_are_found() -> None:
    found = {(command, flag) for command, flag, _ in FLAGS}
    assert {
        ("run", "--deadline"),
        ("scenarios random", "--size-m"),
        ("calibrate", "--depths-m"),
        ("evaluate", "--episodes"),
        ("train", "--mass-kg"),
        ("replay", "--start"),
        ("record", "--split-mb"),
        ("view", "--port"),
        ("export", "--width"),
        ("map", "--cell-m"),
        ("plan-check", "--deadline"),
    } <= found
    assert len(found) > 40


@pytest.mark.parametrize("value", WRONG)
@pytest.mark.parametrize(("command", "flag", "n"), FLAGS)
def test_a_number_that_cannot_be_used_ends_with_2_at_once(
    command: str,
    flag: str,
    n: int,
    value: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def start(*_: object) -> int:
        raise AssertionError("it was started")

    monkeypatch.setattr(cli, "start_program", start)
    monkeypatch.setattr(cli, "execute", start)
    monkeypatch.chdir(tmp_path)
    argv = [*command.split(), *NEEDED.get(command, ()), flag, *n * [value], *AFTER.get(command, ())]
    assert exit_code(argv) == 2
    told = capsys.readouterr().err
    assert any(word in told for word in (flag, flag.strip("-").replace("-", "_"), "obstacles"))
    if told.startswith("error: "):  # The parser of the command line has its own form.
        assert told.count("\n") == 1


def exit_code(argv: list[str]) -> object:
    """The exit code of the command, whether it returns or the parser of its command line exits."""
    try:
        return cli.main(argv)
    except SystemExit as parsed:
        return parsed.code
