"""Writes columns as a Parquet file, with unit and description as metadata of each field."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow
from pyarrow import parquet

from sim_proc.export.columns import Column


def write_parquet(columns: Sequence[Column], about: Mapping[str, str], path: Path) -> None:
    """Write floats and integers with 64 bits, words as a dictionary, and `about` as metadata of the file."""
    fields, arrays = [], []
    for column in columns:
        array = pyarrow.array(column.values.tolist() if column.values.dtype.kind == "U" else column.values)
        if column.values.dtype.kind == "U":
            array = array.dictionary_encode()
        elif not np.issubdtype(column.values.dtype, np.floating):
            array = array.cast(pyarrow.int64())
        fields.append(pyarrow.field(column.name, array.type, metadata={"unit": column.unit, "about": column.about}))
        arrays.append(array)
    schema = pyarrow.schema(fields, metadata={f"legpush.{name}": value for name, value in about.items()})
    parquet.write_table(pyarrow.Table.from_arrays(arrays, schema=schema), path, compression="zstd")
