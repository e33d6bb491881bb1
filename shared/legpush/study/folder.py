"""The folder of a study: what it is, which cells have a row, and which failed."""

import shutil
import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, Literal

import msgspec
from msgspec import Struct

from legpush.errors import ConfigError, DiskFullError
from legpush.files import write_whole
from legpush.runs.folder import own_folder
from legpush.study.rows import SUFFIX, cells_in

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
        except (OSError, msgspec.MsgspecError) as error:
            raise ConfigError(f"{self.path}: expected the folder of a study ({error})") from error

    def source(self) -> str:
        """Read the copy of the study file.

        Raises:
            ConfigError: There is none.
        """
        try:
            return (self.path / STUDY_FILE).read_text(encoding="utf-8")
        except OSError as error:
            raise ConfigError(f"{self.path}: expected the folder of a study ({error})") from error

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
        return cells_in(self.row_files())

    def failures(self) -> list[FailedCell]:
        """Read the cells that failed."""
        return [msgspec.json.decode(file.read_bytes(), type=FailedCell) for file in sorted(self.failed.glob("*.json"))]

    def keep_failure(self, failure: FailedCell) -> None:
        """Write the last words of a cell.

        Raises:
            DiskError: They cannot be written.
        """
        text = msgspec.json.format(msgspec.json.encode(failure), indent=1)
        write_whole(self.failed / f"{failure.cell}.json", text + b"\n")

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
    def opened(self, source: str, record: StudyRecord) -> Iterator[None]:
        """Begin the study in this folder, or go on with it; other heads are kept out until the context is left.

        Raises:
            ConfigError: The folder has other files or another study, or another program uses it.
            DiskError: It cannot be written.
        """
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ConfigError(f"{self.path}: expected a folder that can be written to ({error.strerror})") from error
        with own_folder(self.path):
            if (self.path / RECORD_FILE).exists():
                self._require_same(source, record)
            elif unexpected := sorted({p.name for p in self.path.iterdir() if p.suffix != ".part"} - {STUDY_FILE}):
                raise ConfigError(
                    f"{self.path}: expected a new or empty folder, or that of this study, got one with "
                    f"{', '.join(unexpected[:3])}"
                )
            self._fill(source, record)
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

    def _fill(self, source: str, record: StudyRecord) -> None:
        if not (self.path / RECORD_FILE).exists():
            write_whole(self.path / STUDY_FILE, source.encode())
            self._write_record(record)
        for folder in (self.parts, self.failed):
            folder.mkdir(exist_ok=True)
            for torn in folder.glob("*.part"):
                torn.unlink()

    def _write_record(self, record: StudyRecord) -> None:
        write_whole(self.path / RECORD_FILE, msgspec.json.format(msgspec.json.encode(record), indent=1) + b"\n")

    def _require_same(self, source: str, record: StudyRecord) -> None:
        there = self.record()
        if there.cells_sha256 == record.cells_sha256:
            return
        got: list[str] = []
        if there.kind != record.kind:
            got.append(f"another kind of cell ({there.kind})")
        if there.code != record.code:
            got.append(f"another code version ({there.code} there, {record.code} here)")
        before, now = (tomllib.loads(text) for text in (self.source(), source))
        changed = [key for key in dict.fromkeys([*before, *now]) if before.get(key) != now.get(key)]
        if changed:
            got.append(f"a study file with other {', '.join(changed)}")
        if not got:
            got.append("another scenario, policy or map behind the same names")
        raise ConfigError(
            f"{self.path}: expected the folder of this study, got one with {' and '.join(got)}: results would mix; "
            "give another --out"
        )
