"""This process becomes a program of legpush, or Python under the numerics profile."""

import importlib.util
import os
import sys
from pathlib import Path
from typing import get_args

import pytest

from legpush.processes import start_program as module
from legpush.processes.environment import ONE_THREAD
from legpush.processes.start_program import Program, start_program, start_python
from tests.processors import python

LEGPUSH = ("-c", "import sys; from legpush.cli import main; sys.exit(main())")
NAME = "from legpush.numerics.current import current; print(current().profile)"


@pytest.mark.parametrize("program", get_args(Program))
def test_every_program_is_a_module_that_python_can_run(program: str) -> None:
    spec = importlib.util.find_spec(program)
    assert spec is not None
    assert spec.origin is not None
    assert "\ndef main() -> int:\n" in Path(spec.origin).read_text()


def test_it_becomes_the_program_with_one_thread_per_library(monkeypatch: pytest.MonkeyPatch) -> None:
    became: list[tuple[str, list[str], dict[str, str]]] = []

    def execve(path: str, argv: list[str], environment: dict[str, str]) -> None:
        became.append((path, argv, environment))

    monkeypatch.setattr(os, "execve", execve)
    monkeypatch.setattr(module, "hold", lambda: became.append(("held", [], {})))
    start_program("sim_proc.export.program", ["a.mcap", "--to", "csv"])
    held, (path, argv, environment) = became
    assert held[0] == "held"
    assert (path, argv) == (
        sys.executable,
        [sys.executable, "-P", "-m", "legpush.entry", "sim_proc.export.program", "a.mcap", "--to", "csv"],
    )
    assert ONE_THREAD.items() <= environment.items()


def test_python_gets_its_own_arguments_and_the_profile() -> None:
    done = python(*LEGPUSH, "python", "-W", "error", "-c", f"import sys; print(sys.argv[1:]); {NAME}", "--help", "x y")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "['--help', 'x y']\nx86-64-v3\n"


def test_its_exit_code_is_that_of_python() -> None:
    assert python(*LEGPUSH, "python", "-c", "raise SystemExit(7)").returncode == 7


def test_help_is_about_the_command() -> None:
    assert "Start Python under the numerics profile" in python(*LEGPUSH, "python", "--help").stdout


def test_a_machine_that_cannot_keep_the_profile_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(module, "why_not_here", lambda: "no AVX2")
    monkeypatch.setattr(os, "execve", lambda *_: None)
    start_python(["a.py"])
    assert capsys.readouterr().err == "numerics profile native: no AVX2\n"
