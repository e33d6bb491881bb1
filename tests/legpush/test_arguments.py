"""Command lines: what `--help` shows of an argument, and what is parsed."""

from dataclasses import dataclass
from typing import Annotated, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, Repeated, Switch, arg, parse, words


@dataclass(frozen=True, kw_only=True)
class Bake:
    """Bake a cake."""

    cake: Positional[Annotated[str, arg("NAME|FILE")]] = "plain"
    """The cake."""
    glaze: Annotated[Literal["sugar", "cocoa"] | None, arg()] = None
    """The glaze."""
    changes: Annotated[Repeated[str], arg("FIELD=VALUE", name="set")] = ()
    """Changes."""
    sizes_m: Annotated[tuple[float, float] | None, arg("LOW HIGH")] = None
    """Sizes."""
    tools: Annotated[tuple[str, ...], arg("NAME ...")] = ("spoon",)
    """Tools."""
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


WORDS = st.text(min_size=1).filter(lambda word: not word.startswith("-"))


@given(
    st.builds(
        Bake,
        cake=WORDS,
        glaze=st.sampled_from((None, "sugar", "cocoa")),
        changes=st.lists(st.text(min_size=1), max_size=3).map(tuple),
        sizes_m=st.none() | st.tuples(*2 * [st.floats(0.0, allow_infinity=False)]),
        tools=st.lists(WORDS, max_size=3).map(tuple),
        fast=st.booleans(),
        light=st.booleans(),
        output=st.builds(OutputOptions, json=st.booleans(), quiet=st.booleans()),
    )
)
def test_options_are_written_as_the_words_that_they_are_parsed_from(options: Bake) -> None:
    assert parse(Bake, "bake", words(options)) == options


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
