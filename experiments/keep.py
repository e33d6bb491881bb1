"""`python -m experiments.keep runs/NAME`: keeps the rows of a complete study in `results/rows/`, with its commit.

Packed policies are left out, since they are large, and so are the names of hosts.
"""

import os
import platform
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import tyro
from pyarrow import parquet

from experiments.rows import ROWS, Made, in_runs, write_rows
from legpush.errors import ConfigError
from legpush.service import run_program
from legpush.study.folder import StudyFolder

LEFT_OUT: Final = ("policy_zip", "host")
CHANGES: Final = (
    *("status", "--porcelain", "--untracked-files=no", "--", ":(top)"),
    *(f":(top,exclude){folder}/results" for folder in ("experiments", "benchmarks")),
)
"""Asks Git for changed files, without results."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which studies to keep."""

    folders: Annotated[tyro.conf.Positional[tuple[Path, ...]], tyro.conf.arg(metavar="DIR")]
    """Folders of studies; the rows get the name of the study."""
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")] = ROWS
    """Folder of rows, such as `benchmarks/results/rows` for benchmarks."""


def main(config: Config) -> int:
    """Keep the rows of all studies.

    Raises:
        ConfigError: A study is not complete.
    """
    for path in config.folders:
        print(f"kept {keep(StudyFolder(path), config.out)}")
    return 0


def keep(folder: StudyFolder, out: Path) -> Path:
    """Keep the rows of one study in a folder of rows; return their file.

    Raises:
        ConfigError: It is not a study, or cells have no row.
    """
    record = folder.record()
    n_rows = len(folder.done()) if folder.table.exists() and not folder.part_files() else 0
    if n_rows != record.n_cells:
        raise ConfigError(f"{folder.path}: expected a study with all {record.n_cells} rows in one table, got {n_rows}")
    table = parquet.ParquetFile(folder.table).read()
    made = Made(
        version=record.versions.get("legpush") or "?",
        commit=commit(),
        command=in_runs(record.command, record.name),
        machine=machine(),
        versions=record.versions,
        code=record.code,
    )
    small = table.drop_columns([name for name in LEFT_OUT if name in table.column_names])
    return write_rows(small, record.name, made, out)


def commit(here: Path = Path(__file__).parent) -> str:
    """Return the commit of the repository around a folder, with a `+` if files but results have changes.

    It is `?` outside a repository. Several programs may write results, one after the other.
    """
    try:
        head, changes = (
            subprocess.run(["git", *words], cwd=here, check=True, capture_output=True, text=True).stdout.strip()
            for words in (("rev-parse", "--short=7", "HEAD"), CHANGES)
        )
    except (OSError, subprocess.CalledProcessError):
        return "?"
    return f"{head}+" if changes else head


def machine() -> str:
    """Return processor and number of cores, such as `x86_64, 2 cores`."""
    return f"{platform.machine()}, {os.cpu_count()} cores"


if __name__ == "__main__":
    sys.exit(run_program("keep", lambda: main(tyro.cli(Config))))
