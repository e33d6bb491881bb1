"""The episodes of an evaluation as a table: one row each, with the swept fields and the results."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pyarrow
from pyarrow import parquet

from agent_proc.evaluation.episodes import Row
from agent_proc.evaluation.sweep import Sweep
from legpush.files import write_whole


def table(rows: Sequence[Row], sweep: Sweep) -> list[Mapping[str, Any]]:
    """The cells of each row by column: the case, the swept fields, and the fields of a `Row`."""
    return [{"case": row.case, **sweep.columns(row.case), **asdict(row)} for row in rows]


def as_csv(rows: Sequence[Mapping[str, Any]]) -> str:
    """CSV with a header and one line per episode."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def write_parquet(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Write the table as a Parquet file.

    Raises:
        DiskError: The file cannot be written.
    """
    buffer = pyarrow.BufferOutputStream()
    table = pyarrow.Table.from_pylist([dict(row) for row in rows])
    for index, field in enumerate(table.schema):
        if field.type == pyarrow.null():  # of a number that this world does not know
            numbers = pyarrow.nulls(len(table), pyarrow.float64())
            table = table.set_column(index, field.name, numbers)
    parquet.write_table(table, buffer)
    write_whole(path, buffer.getvalue().to_pybytes())
