"""The folder of a study: what it is, which cells have a row, and which failed."""

import shutil
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import count, takewhile
from pathlib import Path
from typing import Any, Final, Literal, TypeVar

import msgspec
import pyarrow
from msgspec import Struct

from legpush.errors import ConfigError, DiskFullError
from legpush.files import make_folder, write_whole
from legpush.runs.folder import own_folder
from legpush.study.rows import SUFFIX, RowsError, cells_in, read_rows

T = TypeVar("T")

STUDY_FILE: Final = "study.toml"
RECORD_FILE: Final = "study.json"
TABLE_FILE: Final = "cells.parquet"
PARTS: Final = "parts"
FAILED: Final = "failed"
LEAST_FREE_BYTES: Final = 16 * 2**20
"""A study begins and goes on with this much space on the disk, and `ROW_BYTES` for each cell that is missing."""
ROW_BYTES: Final = 1024


class StudyRecord(Struct, frozen=True, kw_only=True):
    """The content of `study.json`."""

    format: Literal[1] = 1
    name: str
    kind: str
    """The kind of cell."""
    n_cells: int
    cells_sha256: str
    """Of all identities of cells, in order: equal for equal studies with equal code."""
    code: str
    """Code version."""
    inputs: tuple[str, ...]
    """Columns with what the cells were given."""
    axes: tuple[str, ...]
    """Those of them that the study varies."""
    may_differ: tuple[str, ...]
    """Result columns that may differ when a cell is run again."""
    units: dict[str, str]
    """Units of result columns that have one."""
    canary: str | None
    """CRC that the canary of each worker has; None if it is not known yet or not needed."""
    versions: dict[str, str | None]
    """Installed where the study began."""
    command: str
    """The command that began it."""


class FailedCell(Struct, frozen=True, kw_only=True):
    """The content of a file in `failed`: a cell without a row, and its last words."""

    cell: str
    inputs: dict[str, Any]
    own: bool
    """Whether the cell itself failed; otherwise its workers were lost."""
    error: str
    traceback: str = ""
    host: str = ""


class StudyFolder:
    """A folder with a study."""

    def __init__(self, path: Path) -> None:
        """Nothing is read or written yet."""
        self.path = path
        self.parts = path / PARTS
        self.failed = path / FAILED
        self.table = path / TABLE_FILE

    def record(self) -> StudyRecord:
        """Read what the study is.

        Raises:
            ConfigError: It is not the folder of a study.
        """
        file = self.path / RECORD_FILE
        try:
            return msgspec.json.decode(file.read_bytes(), type=StudyRecord)
        except OSError as error:
            raise ConfigError(f"{self.path}: expected the folder of a study ({file}: {error.strerror})") from error
        except msgspec.MsgspecError as error:
            raise ConfigError(f"{self.path}: expected the folder of a study ({error})") from error

    def sources(self) -> tuple[str, ...]:
        """Read the copies of the study files: one, or several in a folder of merged studies.

        Raises:
            ConfigError: There is none.
        """
        files = tuple(takewhile(Path.exists, self._source_files()))
        if not files:
            raise ConfigError(f"{self.path}: expected the folder of a study, with {STUDY_FILE}")
        return tuple(file.read_text(encoding="utf-8") for file in files)

    def _source_files(self) -> Iterator[Path]:
        """Yield the names that copies of study files have, in order, without end."""
        yield self.path / STUDY_FILE
        yield from (self.path / STUDY_FILE.replace(".", f"-{number}.") for number in count(2))

    def make_folders(self) -> None:
        """Make the folders for parts and failures."""
        for folder in (self.parts, self.failed):
            folder.mkdir(exist_ok=True)

    def part_files(self) -> list[Path]:
        """Return the parts, whose rows are not in the table yet."""
        return sorted(self.parts.glob(f"*{SUFFIX}"))

    def row_files(self) -> list[Path]:
        """Return all files with rows."""
        return [*([self.table] if self.table.exists() else []), *self.part_files()]

    def done(self) -> set[str]:
        """Return the cells that have a row.

        Raises:
            RowsError: A file cannot be read.
        """
        return self._read(cells_in)

    def rows(self) -> pyarrow.Table | None:
        """Return all rows, one per cell, in no particular order; None if there are none.

        Raises:
            ConfigError: It is not the folder of a study.
            RowsError: A file cannot be read, or the rows of a cell differ; names the cell and the columns.
        """
        may_differ = self.record().may_differ
        return self._read(lambda files: read_rows(files, may_differ))

    def _read(self, read: Callable[[Sequence[Path]], T]) -> T:
        """Read all files; again, if a head has put parts into the table meanwhile."""
        while True:
            files = self.row_files()
            try:
                return read(files)
            except RowsError:
                if all(file.exists() for file in files):
                    raise

    def failures(self) -> list[FailedCell]:
        """Read the cells that failed."""
        return [msgspec.json.decode(file.read_bytes(), type=FailedCell) for file in sorted(self.failed.glob("*.json"))]

    def keep_failure(self, failure: FailedCell) -> None:
        """Write the last words of a cell.

        Raises:
            DiskError: They cannot be written.
        """
        text = msgspec.json.format(msgspec.json.encode(failure), indent=1)
        write_whole(self.failed / f"{failure.cell}.json", text + b"\n", private=True)

    def forget_failures(self, cells: Iterable[str]) -> None:
        """Remove the last words of cells that are run again."""
        for cell in cells:
            (self.failed / f"{cell}.json").unlink(missing_ok=True)

    def set_canary(self, canary: str) -> None:
        """Note the canary of the first worker, which all others must share.

        Raises:
            DiskError: It cannot be written.
        """
        self._write_record(msgspec.structs.replace(self.record(), canary=canary))

    def remove_parts(self, parts: Iterable[Path]) -> None:
        """Remove parts whose rows are in the table."""
        for part in parts:
            part.unlink(missing_ok=True)

    @contextmanager
    def opened(self, sources: Sequence[str], record: StudyRecord, *, private: bool = False) -> Iterator[None]:
        """Begin the study in this folder, or go on with it; other heads are kept out until the context is left.

        Only the user can enter a new folder that is `private`.

        Raises:
            ConfigError: The folder has other files or another study, or another program uses it.
            DiskError: It cannot be written.
        """
        try:
            make_folder(self.path, private=private)
        except OSError as error:
            raise ConfigError(f"{self.path}: expected a folder that can be written to ({error.strerror})") from error
        with own_folder(self.path):
            if (self.path / RECORD_FILE).exists():
                self._require_same(sources, record)
            elif unexpected := sorted({p.name for p in self.path.iterdir() if p.suffix != ".part"} - {STUDY_FILE}):
                raise ConfigError(
                    f"{self.path}: expected a new or empty folder, or that of this study, got one with "
                    f"{', '.join(unexpected[:3])}"
                )
            self._fill(sources, record)
            yield

    def require_space(self, n_missing: int) -> None:
        """Check that the disk has space for the rows that are missing.

        Raises:
            DiskFullError: It has not.
        """
        free, least = shutil.disk_usage(self.path).free, LEAST_FREE_BYTES + ROW_BYTES * n_missing
        if free < least:
            raise DiskFullError(
                f"{self.path}: expected {least / 2**20:.0f} MiB of space on the disk for {n_missing} rows, got "
                f"{free / 2**20:.0f} MiB"
            )

    def _fill(self, sources: Sequence[str], record: StudyRecord) -> None:
        if not (self.path / RECORD_FILE).exists():
            for file, source in zip(self._source_files(), sources, strict=False):
                write_whole(file, source.encode())
            self._write_record(record)
        self.make_folders()
        for folder in (self.path, self.parts, self.failed):
            for torn in folder.glob("*.part"):
                torn.unlink()

    def _write_record(self, record: StudyRecord) -> None:
        text = msgspec.json.format(msgspec.json.encode(record), indent=1) + b"\n"
        write_whole(self.path / RECORD_FILE, text, private=True)

    def _require_same(self, sources: Sequence[str], record: StudyRecord) -> None:
        there = self.record()
        if there.cells_sha256 == record.cells_sha256:
            return
        got: list[str] = []
        if there.kind != record.kind:
            got.append(f"another kind of cell ({there.kind})")
        if there.code != record.code:
            got.append(f"another code version ({there.code} there, {record.code} here)")
        there_is, now = self.sources(), tuple(sources)
        if len(there_is) != len(now):
            got.append(f"{len(there_is)} merged studies")
        else:
            pairs = [(tomllib.loads(a), tomllib.loads(b)) for a, b in zip(there_is, now, strict=True)]
            changed = [key for a, b in pairs for key in dict.fromkeys([*a, *b]) if a.get(key) != b.get(key)]
            if changed:
                got.append(f"a study file with other {', '.join(changed)}")
        if not got:
            got.append("another scenario, policy or map behind the same names")
        raise ConfigError(
            f"{self.path}: expected the folder of this study, got one with {' and '.join(got)}: results would mix; "
            "give another --out"
        )
