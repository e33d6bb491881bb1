"""This process becomes a program of one of the process packages."""

import importlib.util
import os
import sys
from typing import get_args

import pytest

from legpush.processes.environment import ONE_THREAD
from legpush.processes.start_program import Program, start_program


@pytest.mark.parametrize("program", get_args(Program))
def test_every_program_is_a_module_that_python_can_run(program: str) -> None:
    spec = importlib.util.find_spec(program)
    assert spec is not None
    if spec.submodule_search_locations is not None:
        assert importlib.util.find_spec(f"{program}.__main__") is not None


def test_it_becomes_the_program_with_one_thread_per_library(monkeypatch: pytest.MonkeyPatch) -> None:
    became: list[tuple[str, list[str], dict[str, str]]] = []

    def execve(path: str, argv: list[str], environment: dict[str, str]) -> None:
        became.append((path, argv, environment))

    monkeypatch.setattr(os, "execve", execve)
    start_program("sim_proc.export", ["a.mcap", "--to", "csv"])
    ((path, argv, environment),) = became
    assert (path, argv) == (sys.executable, [sys.executable, "-P", "-m", "sim_proc.export", "a.mcap", "--to", "csv"])
    assert ONE_THREAD.items() <= environment.items()
