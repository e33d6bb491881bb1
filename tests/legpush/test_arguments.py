"""Command lines: what `--help` shows of an argument, and what is parsed."""

from dataclasses import dataclass
from typing import Annotated, Literal

import pytest

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, Repeated, Switch, arg, parse


@dataclass(frozen=True, kw_only=True)
class Bake:
    """Bake a cake."""

    cake: Positional[Annotated[str, arg("NAME|FILE")]] = "plain"
    """The cake."""
    glaze: Annotated[Literal["sugar", "cocoa"] | None, arg()] = None
    """The glaze."""
    changes: Annotated[Repeated[str], arg("FIELD=VALUE", name="set")] = ()
    """Changes."""
    fast: Flag = False
    """Hurry. A cake that is baked in a hurry is a cake that is not done in the middle, and one that nobody wants to eat
    warm.

    It is eaten all the same."""
    light: Switch = True
    """Leave the light on."""
    output: OutputOptions = USUAL_OUTPUT


def test_what_is_given_is_parsed_in_any_order() -> None:
    assert parse(Bake, "bake", []) == Bake()
    argv = ["--set", "a=1", "nut", "--glaze", "cocoa", "--set", "b=2", "--fast", "--no-light", "-q", "--json"]
    assert parse(Bake, "bake", argv) == Bake(
        cake="nut",
        glaze="cocoa",
        changes=("a=1", "b=2"),
        fast=True,
        light=False,
        output=OutputOptions(json=True, quiet=True),
    )


def test_help_shows_choices_and_defaults_that_say_something(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parse(Bake, "bake", ["--help"])
    text = capsys.readouterr().out
    assert "{sugar,cocoa}" in text
    assert "(default: plain)" in text
    assert "(default: yes)" in text
    for nothing in ("None", "(default: )", "False", "--no-fast"):
        assert nothing not in text


def test_help_breaks_the_lines_of_a_docstring_where_the_terminal_ends_and_between_paragraphs(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    with pytest.raises(SystemExit):
        parse(Bake, "bake", ["--help"])
    text = capsys.readouterr().out
    assert "nobody wants to eat warm. " in text
    assert "warm. It is" not in text


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["--glaze", "None"], "invalid choice 'None' for argument '--glaze'. Expected one of ('sugar', 'cocoa')."),
        (["--glze", "sugar"], "--glaze"),
        (["--no-fast"], "--no-fast"),
    ],
)
def test_a_wrong_argument_ends_with_2(argv: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        parse(Bake, "bake", argv)
    assert end.value.code == 2
    assert words in " ".join(capsys.readouterr().err.replace("│", " ").split())
