"""The table of commands: one name for each idea, in all commands."""

import json
import re
import subprocess
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, Final, get_args, get_origin, get_type_hints

import pytest

from legpush.arguments import OutputOptions
from legpush.cli import main
from legpush.cli.commands import all_commands
from legpush.options.numerics import PythonOptions
from legpush.options.shell import CompletionOptions
from legpush.scenarios.file import scenario_names
from tests.docs.help_texts import help_texts

SEVERAL: Final = {
    "out": {"DIR", "FILE"},
    "file": {"FILE", "NAME|FILE", "FILE|DIR"},
    "run": {"NAME", "NAME|FOLDER"},
    "world": {"NAME", "NAME|FILE"},
    "friction": {"MU", "LOW HIGH"},
    "mass_kg": {"KG", "LOW HIGH"},
    "init": {"POLICY|DIR"},
    "hosts": {"HOST", "HOST[=ADDRESS,...]"},
}
"""Metavars of fields that have another one in another command, and why: a folder or a file, a number or an interval."""


def metavars() -> Iterator[tuple[str, str, str | None, str]]:
    """Command, field, metavar and type of every argument."""
    for command, options in all_commands().items():
        hints = get_type_hints(options, include_extras=True)
        for field in fields(options):
            kind, metavar = hints[field.name], None
            while get_origin(kind) is Annotated:
                kind, *about = get_args(kind)
                metavar = next(filter(None, (getattr(each, "metavar", None) for each in about)), metavar)
            yield command, field.name, metavar, str(kind)


def test_a_field_has_one_metavar_in_all_commands() -> None:
    found: dict[str, set[str]] = {}
    for _, field, metavar, _ in metavars():
        if metavar is not None:
            found.setdefault(field, set()).add(metavar)
    assert len(found) > 50
    several = {field: words for field, words in found.items() if len(words) > 1}
    assert all(words <= SEVERAL.get(field, set()) for field, words in several.items()), several


def test_every_value_has_a_metavar_or_choices() -> None:
    bare = [
        f"{command} --{field}"
        for command, field, metavar, kind in metavars()
        if metavar is None and "Literal" not in kind and "bool" not in kind and "OutputOptions" not in kind
    ]
    assert bare == []


def test_every_command_replies_in_json_or_quietly() -> None:
    without: dict[str, Any] = {
        name: options
        for name, options in all_commands().items()
        if not any(field.type is OutputOptions or field.type == "OutputOptions" for field in fields(options))
    }
    assert without == {"python": PythonOptions, "completion": CompletionOptions}


def test_no_help_shows_a_default_that_says_nothing() -> None:
    for command, text in help_texts().items():
        assert not re.search(r"default: (\)|None|False)|None,|\bSTR\b|\bFLOAT\b|\bINT\b", text), command


def test_a_mistyped_flag_is_answered_for_its_command_alone(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["calibrate", "--serie", "3"])
    said = capsys.readouterr().err
    assert "--series" in said
    assert "legpush calibrate --help" in said
    for other in ("evaluate", "train", "legpush run"):
        assert other not in said


def test_a_dry_run_prints_the_scenario_and_starts_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("legpush.launch.run._run_and_tell", lambda *_: pytest.fail("it began"))
    assert main(["run", "push", "--set", "box.mass_kg=0.9", "--policy", "scripted", "--dry-run", "--json", "-q"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["scenario"]["box"]["mass_kg"] == 0.9
    assert told["policy"] == "scripted"
    assert list(tmp_path.iterdir()) == []


def test_the_list_of_scenarios_is_a_document_for_programs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenarios", "list", "--json", "--quiet"]) == 0
    assert [each["name"] for each in json.loads(capsys.readouterr().out)] == list(scenario_names())


@pytest.mark.parametrize(
    ("words", "completions"),
    [
        ("rec", {"record", "recover"}),
        ("run --pl", {"--planner", "--planner-command"}),
        ("run --planner rrt_c", {"rrt_connect"}),
        ("scenarios sh", {"show"}),
    ],
)
def test_bash_completes_commands_flags_and_choices(
    words: str, completions: set[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["completion", "bash"]) == 0
    script = capsys.readouterr().out
    name = re.search(r"complete .*-F (\S+) legpush", script)
    assert name is not None
    split = ["legpush", *words.split()]
    ask = (
        f"COMP_WORDS=({' '.join(split)}); COMP_CWORD={len(split) - 1}; {name[1]}; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    )
    done = subprocess.run(["bash", "-c", f"{script}\n{ask}"], capture_output=True, text=True, check=False)
    assert {line.strip() for line in done.stdout.splitlines()} == completions, done.stderr


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_have_a_script(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    assert "legpush" in capsys.readouterr().out
