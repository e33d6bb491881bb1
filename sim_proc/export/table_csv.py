"""Writes columns as a CSV file. Numbers are written so that reading them gives the same bits."""

import csv
from collections.abc import Sequence
from pathlib import Path

from sim_proc.export.columns import Column


def write_csv(columns: Sequence[Column], path: Path) -> None:
    """Write a line of names, then a line for each row, with `nan` for unknown values."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([column.name for column in columns])
        writer.writerows(zip(*(column.values.tolist() for column in columns), strict=True))
