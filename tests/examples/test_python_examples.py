"""The examples of the Python face run as they stand."""

import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("in_one_process.py", ["success: box error", "push cycles, ", "the first of "]),
        ("step_by_step.py", ["robot at ", "exact: ", "walked to ", "FL: peak ", "FR: peak "]),
    ],
)
def test_an_example_runs_and_prints_what_it_found(name: str, lines: list[str], tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(FOLDER / name)], cwd=tmp_path, check=False, capture_output=True, text=True, timeout=240
    )
    assert done.returncode == 0, done.stderr
    for line in lines:
        assert line in done.stdout
    assert list(tmp_path.iterdir()) == []
