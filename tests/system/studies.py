"""Studies of quick cells, run by the command line in a process of its own."""

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

from pyarrow import parquet

from tests.system.missions import LEGPUSH

CELL: Final = """
import os, pathlib, platform, time

def cell(x: int, seconds: float = 0.0, marks: str = "") -> dict:
    if marks:
        with open(pathlib.Path(marks) / f"{x}-{platform.node()}-{os.getpid()}-{time.time_ns()}", "w"):
            pass
    time.sleep(seconds)
    return {"square": x * x, "state_crc": f"{x * 2654435761 % 2**32:08x}"}
"""
"""A cell that leaves a mark each time it is begun."""


def write_study(folder: Path, *, n_cells: int, seconds: float) -> None:
    """Write a study file and the cell's own module into a folder."""
    (folder / "marks").mkdir()
    (folder / "quick.py").write_text(CELL)
    settings = f'seconds = {seconds}\nmarks = "{folder / "marks"}"'
    (folder / "study.toml").write_text(
        f'name = "quick"\n[settings]\n{settings}\n[axes]\nx = {{first = 0, n = {n_cells}}}\n'
    )


def study_command(*options: str) -> list[str]:
    """Return the command that runs the study of the present folder."""
    return [*LEGPUSH, "study", "run", "study.toml", "--cell", "quick:cell", "--out", "study", *options]


def start_study(
    folder: Path,
    *options: str,
    environment: Mapping[str, str] = os.environ,
    inside: Callable[[list[str]], list[str]] = list,
) -> "subprocess.Popen[str]":
    """Start the study of a folder, by a command that `inside` may wrap."""
    return subprocess.Popen(
        inside(study_command(*options)),
        cwd=folder,
        env={**environment, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def rows_of(folder: Path) -> list[dict[str, Any]]:
    """Return the rows of the finished study of a folder."""
    rows: list[dict[str, Any]] = parquet.read_table(folder / "study" / "cells.parquet").to_pylist()
    return rows


def require_each_cell_once(folder: Path, n_cells: int) -> None:
    """Check that every cell has one row, with the right numbers."""
    rows = rows_of(folder)
    assert sorted(row["x"] for row in rows) == list(range(n_cells))
    assert [row["square"] for row in rows] == [row["x"] ** 2 for row in rows]


def begun(folder: Path) -> list[int]:
    """Return the cells that were begun so far; one that was begun again is there twice."""
    return sorted(int(mark.name.partition("-")[0]) for mark in (folder / "marks").iterdir())
