"""A process that was started by hand becomes itself again, once, with its own arguments."""

import json
import os
import sys
from pathlib import Path
from typing import Any

import pytest

from legpush.numerics import entry
from legpush.numerics.entry import enter_profile, is_watched
from legpush.numerics.profile import VARIABLE
from tests.processors import plain_environment, python

PROGRAM = """
import json, os, sys
from legpush.numerics.current import current
from legpush.numerics.entry import enter_profile
print("begun", flush=True)
{before}
enter_profile()
print(json.dumps([sys.argv[1:], sys.warnoptions, current().name.partition("/")[0], current().why_native]))
"""


def run(tmp_path: Path, before: str = "", environment: dict[str, str] | None = None) -> tuple[int, list[Any]]:
    """How often the program began, and what it printed at its end."""
    program = tmp_path / "program.py"
    program.write_text(PROGRAM.format(before=before))
    done = python("-W", "error::UserWarning", str(program), "a b", "--flag=ä", "", environment=environment)
    assert done.returncode == 0, done.stderr
    *begun, last = done.stdout.splitlines()
    assert set(begun) == {"begun"}
    return len(begun), json.loads(last)


def test_it_starts_again_once_with_the_arguments_of_program_and_interpreter(tmp_path: Path) -> None:
    n_begun, (argv, warn, profile, why) = run(tmp_path)
    assert (n_begun, profile, why) == (2, "x86-64-v3", "")
    assert argv == ["a b", "--flag=ä", ""]
    assert warn == ["error::UserWarning"]


def test_not_if_the_user_asks_for_native(tmp_path: Path) -> None:
    n_begun, (_, _, profile, why) = run(tmp_path, environment={**plain_environment(), VARIABLE: "native"})
    assert (n_begun, profile, why) == (1, "native", "")


def test_not_twice_if_the_profile_does_not_take_effect(tmp_path: Path) -> None:
    without_avx2 = {**plain_environment(), "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2"}
    n_begun, (_, _, profile, why) = run(tmp_path, environment=without_avx2)
    assert (n_begun, profile, why) == (2, "native", "glibc uses FMA")


@pytest.mark.parametrize(
    "debugger",
    [
        "sys.settrace(lambda *_: None)",
        pytest.param(
            "sys.monitoring.use_tool_id(sys.monitoring.DEBUGGER_ID, 'debugger')",
            marks=pytest.mark.skipif(sys.version_info < (3, 12), reason="sys.monitoring came with Python 3.12"),
        ),
    ],
)
def test_not_under_a_debugger(tmp_path: Path, debugger: str) -> None:
    n_begun, _ = run(tmp_path, debugger)
    assert n_begun == 1


def test_not_where_python_does_not_know_how_it_was_started(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a program that embeds it."""
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr(os, "execve", lambda *_: pytest.fail("started again"))
    monkeypatch.setattr(sys, "orig_argv", [])
    enter_profile()


def test_not_on_a_machine_that_cannot_keep_the_profile(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr(os, "execve", lambda *_: pytest.fail("started again"))
    monkeypatch.setattr(entry, "with_profile", dict)
    enter_profile()


def test_a_library_does_not_start_the_program_of_its_user_again() -> None:
    done = python("-c", "print('begun'); import legpush; legpush.load_scenario('push'); legpush.run; legpush.world")
    assert done.stdout == "begun\n"


def test_nothing_watches_here() -> None:
    assert is_watched() == (sys.gettrace() is not None)
