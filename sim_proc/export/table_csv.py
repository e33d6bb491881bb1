"""Columns as a CSV file: numbers as Python writes them, which gives the same bits when they are read again."""

import csv
from collections.abc import Sequence
from pathlib import Path

from sim_proc.export.columns import Column


def write_csv(columns: Sequence[Column], path: Path) -> None:
    """One line of names, then one per row; `nan` where a value is not known."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([column.name for column in columns])
        writer.writerows(zip(*(column.values.tolist() for column in columns), strict=True))
