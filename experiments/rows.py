"""The rows of the studies, in `results/rows/`: a Parquet file each, which says how it was made."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import msgspec
import pyarrow
from msgspec import Struct
from msgspec.structs import replace
from pyarrow import parquet

from legpush.errors import ConfigError
from legpush.study.rows import SUFFIX, write_table

RESULTS: Final = Path(__file__).parent / "results"
ROWS: Final = RESULTS / "rows"
METADATA: Final = b"legpush.made"
"""Key of the metadata of a file that has its `Made`."""
Row = dict[str, Any]


class Made(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How rows or numbers were made."""

    version: str
    """Version of legpush."""
    commit: str
    """Commit of this repository; a `+` at its end says that files had changes."""
    command: str
    machine: str = ""
    versions: dict[str, str | None] = {}
    """Versions of the installed packages."""
    code: str = ""
    """Code version of the study, if it was one."""
    note: str = ""

    def words(self) -> str:
        """Return version and commit, such as `0.1.0, commit 3fbd4a7`."""
        return f"{self.version}, commit {self.commit}"


@dataclass(frozen=True, kw_only=True)
class Rows:
    """The rows of a study."""

    rows: list[Row]
    made: Made

    def where(self, **values: Any) -> list[Row]:
        """Return the rows with these values."""
        return [row for row in self.rows if all(row[name] == value for name, value in values.items())]


def has_rows(name: str, folder: Path = ROWS) -> bool:
    """Whether the rows of a study have been kept."""
    return (folder / f"{name}{SUFFIX}").exists()


def read_rows(name: str, folder: Path = ROWS) -> Rows:
    """Read the rows of a study in a folder of rows.

    Raises:
        ConfigError: There are none.
    """
    file = folder / f"{name}{SUFFIX}"
    try:
        table = parquet.ParquetFile(file).read()
        made = msgspec.json.decode((table.schema.metadata or {})[METADATA], type=Made)
    except (OSError, KeyError, pyarrow.ArrowException, msgspec.MsgspecError) as error:
        raise ConfigError(
            f"{file}: expected the rows of a study, as `python -m experiments.keep` writes them"
        ) from error
    return Rows(rows=table.to_pylist(), made=replace(made, command=in_runs(made.command, name)))


def in_runs(command: str, name: str) -> str:
    """Return a command of a study with the folder of this page, `runs/NAME`, in place of any other one."""
    return re.sub(r"--out \S+", f"--out runs/{name}", command)


def write_rows(table: pyarrow.Table, name: str, made: Made, folder: Path = ROWS) -> Path:
    """Write the rows of a study, in place of the previous ones; return their file.

    Raises:
        DiskError: The file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}{SUFFIX}"
    write_table(table.replace_schema_metadata({METADATA: msgspec.json.encode(made)}), path)
    return path
