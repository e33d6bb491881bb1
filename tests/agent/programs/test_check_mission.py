"""The program that checks what a mission needs, with the flags of an agent."""

import sys

import pytest

from agent_proc.programs.check_mission import main


@pytest.mark.parametrize(
    ("flags", "code", "words"),
    [
        (["--scenario", "push", "--policy", "scripted"], 0, ""),
        (["--scenario", "nowhere.toml"], 2, "error: nowhere.toml: expected a readable scenario file"),
        (["--scenario", "push", "--policy", "nosuch"], 2, "error: Expected a policy (dynamic_programming, fixed"),
    ],
)
def test_the_inputs_of_a_mission_are_made_and_nothing_is_started(
    flags: list[str], code: int, words: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["check_mission", *flags])
    assert main() == code
    assert capsys.readouterr().err.startswith(words)
