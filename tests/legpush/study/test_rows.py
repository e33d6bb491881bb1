from math import inf, nan
from pathlib import Path

import pytest
from pyarrow import parquet

from legpush.files import DiskError
from legpush.study.rows import (
    RowsError,
    cells_in,
    described,
    differences,
    in_order,
    joined,
    read_rows,
    write_part,
    write_table,
)


def row(cell: str, **columns: object) -> dict[str, object]:
    return {"cell": cell, "value": 1.0, "host": "a", **columns}


def test_rows_come_back_with_columns_that_only_some_of_them_have(tmp_path: Path) -> None:
    parts = [write_part(tmp_path, [row("a", n=1, least=inf)]), write_part(tmp_path, [row("b", words=["x"]), row("c")])]
    table = read_rows(parts)
    assert table is not None
    by_cell = {each["cell"]: each for each in table.to_pylist()}
    assert by_cell["a"] == row("a", n=1, least=inf, words=None)
    assert by_cell["b"]["words"] == ["x"]
    assert by_cell["c"]["n"] is None
    assert cells_in(parts) == {"a", "b", "c"}


def test_without_files_there_are_no_rows() -> None:
    assert read_rows([]) is None


def test_whole_numbers_and_fractions_of_a_column_become_fractions(tmp_path: Path) -> None:
    table = read_rows([write_part(tmp_path, [row("a", mass=1)]), write_part(tmp_path, [row("b", mass=0.5)])])
    assert table is not None
    assert table.column("mass").to_pylist() == [1.0, 0.5]


def test_a_cell_that_was_run_twice_with_equal_results_has_one_row(tmp_path: Path) -> None:
    parts = [
        write_part(tmp_path, [row("a", host=host, took_s=took, none=nan)]) for host, took in (("x", 1.0), ("y", 2.0))
    ]
    table = read_rows(parts, ["took_s"])
    assert table is not None
    assert table.num_rows == 1


def test_a_cell_with_different_results_is_an_error_that_names_it(tmp_path: Path) -> None:
    parts = [write_part(tmp_path, [row("a"), row("b")]), write_part(tmp_path, [row("b", value=2.0)])]
    with pytest.raises(RowsError, match="Expected equal rows of the cell b, got different value"):
        read_rows(parts)


def test_a_torn_file_is_named(tmp_path: Path) -> None:
    part = write_part(tmp_path, [row("a")])
    part.write_bytes(part.read_bytes()[:-20])
    with pytest.raises(RowsError, match=f"{part.name}: expected a Parquet file"):
        read_rows([part])


def test_a_column_of_two_types_is_named(tmp_path: Path) -> None:
    with pytest.raises(RowsError, match="one type in the column value"):
        write_part(tmp_path, [row("a"), row("b", value="x")])
    with pytest.raises(RowsError, match="one type each"):
        read_rows([write_part(tmp_path, [row("a")]), write_part(tmp_path, [row("b", value="x")])])


def test_a_value_that_parquet_cannot_hold_is_an_error_of_the_row(tmp_path: Path) -> None:
    with pytest.raises(RowsError, match="expected columns that Parquet can hold"):
        write_part(tmp_path, [row("a", value={})])


def test_a_part_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(DiskError):
        write_part(tmp_path / "none", [row("a")])
    assert list(tmp_path.iterdir()) == []


def test_differences_leave_out_what_may_differ() -> None:
    a, b = row("a", took_s=1.0, none=nan), row("a", took_s=2.0, host="b", none=nan, more=1)
    assert differences(a, b, ["took_s"]) == ["more"]


def test_a_table_is_put_in_order_and_described(tmp_path: Path) -> None:
    table = joined([read_rows([write_part(tmp_path, [row(cell) for cell in "cab"])])])
    write_table(described(in_order(table, ["a", "b", "c"]), {"value": "m"}, "about"), tmp_path / "t.parquet")
    read = parquet.read_table(tmp_path / "t.parquet")
    assert read.column("cell").to_pylist() == ["a", "b", "c"]
    assert read.schema.field("value").metadata == {b"unit": b"m"}
    assert read.schema.metadata[b"legpush.study"] == b"about"
