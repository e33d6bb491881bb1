"""The programs of the experiments say in one line what they cannot use."""

import subprocess
import sys
from pathlib import Path

import pytest

CASES = {
    "keep": ("nothing: expected the folder of a study",),
    "policies": ("nothing: expected the folder of a study",),
    "tables": ("Expected tables among", "got nothing"),
}


@pytest.mark.parametrize("program", CASES)
def test_bad_input_is_one_line_and_exit_code_2(program: str) -> None:
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-m", f"experiments.{program}", "nothing"],
        cwd=root,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: ")
    assert all(words in line for words in CASES[program]), line
