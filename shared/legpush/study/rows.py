"""Rows of a study as Parquet: parts that appear whole or not at all, and one table without duplicates."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final
from uuid import uuid4

import pyarrow
from pyarrow import parquet

from legpush.errors import LegpushError
from legpush.files import write_whole

CELL: Final = "cell"
"""The column with the identity of the cell."""
SUFFIX: Final = ".parquet"
DIFFERING: Final = frozenset({"numerics", "versions", "host", "cpu_s", "wall_s"})
"""Columns that say where and how long a cell ran; all others are equal when it is run again."""


class RowsError(LegpushError):
    """Rows that cannot be read or that contradict each other; names the file, or the cell."""


def write_part(folder: Path, rows: Sequence[Mapping[str, Any]]) -> Path:
    """Write rows as a new file in `folder`, and return its path.

    Raises:
        DiskError: The file cannot be written.
        RowsError: A column has values of different types.
    """
    path = folder / f"{uuid4().hex}{SUFFIX}"
    write_table(_table(rows), path)
    return path


def write_table(table: pyarrow.Table, path: Path) -> None:
    """Write a table as a file, in place of the previous one.

    Raises:
        DiskError: The file cannot be written.
        RowsError: A column has values that Parquet cannot hold.
    """
    buffer = pyarrow.BufferOutputStream()
    try:
        parquet.write_table(table, buffer, compression="zstd")
    except pyarrow.ArrowException as error:
        raise RowsError(f"{path}: expected columns that Parquet can hold ({error})") from error
    write_whole(path, buffer.getvalue().to_pybytes())


def cells_in(files: Iterable[Path]) -> set[str]:
    """Return the identities of the cells that have a row.

    Raises:
        RowsError: A file cannot be read.
    """
    return {cell for file in files for cell in _read(file, [CELL]).column(CELL).to_pylist()}


def read_rows(files: Sequence[Path], may_differ: Iterable[str] = ()) -> pyarrow.Table | None:
    """Return all rows, one per cell, in no particular order; None without files.

    A cell may have several rows, since a worker that was given up may have finished it after all. Then they are equal,
    but for the columns that may differ.

    Raises:
        RowsError: A file cannot be read, or the rows of a cell differ; names the cell and the columns.
    """
    if not files:
        return None
    table = joined([_read(file) for file in files])
    cells = table.column(CELL).to_pylist()
    first: dict[str, int] = {}
    again: list[tuple[int, int]] = []
    for index, cell in enumerate(cells):
        if (earlier := first.setdefault(cell, index)) != index:
            again.append((earlier, index))
    for earlier, later in again:
        a, b = (table.slice(index, 1).to_pylist()[0] for index in (earlier, later))
        if different := differences(a, b, may_differ):
            raise RowsError(f"Expected equal rows of the cell {cells[later]}, got different {', '.join(different)}")
    return table.take(pyarrow.array(list(first.values()))) if again else table


def differences(a: Mapping[str, Any], b: Mapping[str, Any], may_differ: Iterable[str] = ()) -> list[str]:
    """Return the columns in which two rows of one cell differ and must not; NaN equals NaN."""
    free = {*DIFFERING, *may_differ}
    return [name for name in dict.fromkeys([*a, *b]) if name not in free and repr(a.get(name)) != repr(b.get(name))]


def in_order(table: pyarrow.Table, cells: Sequence[str]) -> pyarrow.Table:
    """Return the rows in the order of `cells`, which has all of them."""
    place = {cell: index for index, cell in enumerate(cells)}
    found = table.column(CELL).to_pylist()
    order = sorted(range(len(found)), key=lambda row: place[found[row]])
    return table.take(pyarrow.array(order, type=pyarrow.int64()))


def described(table: pyarrow.Table, units: Mapping[str, str], about: str) -> pyarrow.Table:
    """Return the table with units as metadata of its columns, and `about` as metadata of the file."""
    fields = [field.with_metadata({"unit": units.get(field.name, "")}) for field in table.schema]
    return table.cast(pyarrow.schema(fields, metadata={"legpush.study": about}))


def joined(tables: Sequence[pyarrow.Table]) -> pyarrow.Table:
    """Return tables as one, with all columns of any of them.

    Raises:
        RowsError: A column has different types.
    """
    try:
        return pyarrow.concat_tables(tables, promote_options="permissive").combine_chunks()
    except (pyarrow.ArrowInvalid, pyarrow.ArrowTypeError) as error:
        raise RowsError(f"Expected columns of one type each in all rows ({error})") from error


def _table(rows: Sequence[Mapping[str, Any]]) -> pyarrow.Table:
    names = dict.fromkeys(name for row in rows for name in row)
    columns = {}
    for name in names:
        try:
            columns[name] = pyarrow.array([row.get(name) for row in rows])
        except (pyarrow.ArrowInvalid, pyarrow.ArrowTypeError) as error:
            raise RowsError(f"Expected values of one type in the column {name} ({error})") from error
    return pyarrow.table(columns)


def _read(file: Path, columns: list[str] | None = None) -> pyarrow.Table:
    try:
        return parquet.ParquetFile(file).read(columns=columns)
    except (OSError, pyarrow.ArrowException) as error:
        raise RowsError(f"{file}: expected a Parquet file with rows of a study ({error})") from error
