"""`docs/write_a_planner.md`, done as a reader would: files are written, commands run, and their output compared."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GUIDE = ROOT / "docs" / "write_a_planner.md"
APPENDED = ", at the end"


def blocks() -> list[tuple[str, str]]:
    """Language and text of each block of code."""
    return re.findall(r"^```(\w+)\n(.*?)^```$", GUIDE.read_text(), re.MULTILINE | re.DOTALL)


def commands(text: str) -> Iterator[tuple[str, list[str]]]:
    """Each command of a block, and the lines that it should print."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, *output = part.splitlines()
        yield command, output


def fits(expected: list[str], got: list[str]) -> bool:
    """Whether lines are as expected, `...` being any number of lines."""
    if not expected:
        return not got
    if expected[0] == "...":
        return any(fits(expected[1:], got[skipped:]) for skipped in range(len(got) + 1))
    return bool(got) and got[0] == expected[0] and fits(expected[1:], got[1:])


@pytest.mark.timeout(900)
def test_what_the_guide_says_is_what_a_reader_sees(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("__pycache__"))
    folder = tmp_path
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "PYTHONDONTWRITEBYTECODE": "1", "COLUMNS": "80"}
    n_commands = 0
    for language, text in blocks():
        if language == "python":
            title, _, code = text.partition("\n")
            name = title.removeprefix("# ").removesuffix(APPENDED)
            file = folder / name
            before = file.read_text() if title.endswith(APPENDED) else ""
            file.write_text(before + code)
            continue
        assert language == "console"
        for command, expected in commands(text):
            if command.startswith("cd "):
                folder /= command.removeprefix("cd ")
                continue
            done = subprocess.run(
                command,
                shell=True,
                cwd=folder,
                env=environment,
                capture_output=True,
                text=True,
                check=False,
                timeout=240,
            )
            got = [line.rstrip() for line in done.stdout.splitlines()]
            assert fits(expected, got), f"{command}\n{done.stdout}{done.stderr}"
            n_commands += 1
    assert n_commands > 8
