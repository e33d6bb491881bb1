"""The exit code of a program, and what it prints about a fault."""

from pathlib import Path

import pytest

from tests.legpush.entry.programs import Ended, run


@pytest.mark.parametrize(
    ("end", "ended"),
    [
        ("return 0", Ended(0, "", "")),
        ("return 1", Ended(1, "", "")),
        ("sys.exit(2)", Ended(2, "", "")),
        ("sys.exit()", Ended(0, "", "")),
        ("sys.exit('no more')", Ended(3, "", "no more\n")),
    ],
)
def test_the_exit_code_is_that_of_the_work(end: str, ended: Ended, tmp_path: Path) -> None:
    assert run(tmp_path, f"def main():\n    {end}\n") == ended


def test_a_fault_is_a_traceback_and_code_3(tmp_path: Path) -> None:
    ended = run(tmp_path, "def main():\n    raise ValueError('broken')\n")
    assert ended.exit_code == 3
    assert ended.err.startswith("Traceback (most recent call last):\n")
    assert ended.err.endswith("ValueError: broken\n")


def test_arguments_are_those_of_main_or_of_the_command_line(tmp_path: Path) -> None:
    work = "def main(*words):\n    print(words, sys.argv[1:])\n    return 0\n"
    called = "import sys; from legpush.entry.program import run_main; sys.exit(run_main('work', 'a', 'b'))"
    assert run(tmp_path, work, called) == Ended(0, "('a', 'b') []\n", "")
    by_name = "import os, sys; os.execv(sys.executable, [sys.executable, '-m', 'legpush.entry', 'work', '--flag', 'x'])"
    assert run(tmp_path, work, by_name) == Ended(0, "() ['--flag', 'x']\n", "")
