"""Logs a training as CSV: a row for each update and evaluation, whole after every row."""

import csv
from pathlib import Path
from typing import Any, Final

from stable_baselines3.common.logger import KVWriter

CSV_FILE: Final = "log.csv"
STEP: Final = "step"


class CsvLog(KVWriter):
    """The file `log.csv` in the folder of a training; new columns come behind those before."""

    def __init__(self, folder: Path, step: int) -> None:
        """Begin the file, or go on behind a step: later rows are dropped, since they come again."""
        self._path = folder / CSV_FILE
        self._columns = [STEP]
        self._rows: list[dict[str, str]] = []
        if step and self._path.exists():
            with self._path.open(encoding="utf-8", newline="") as file:
                reader = csv.DictReader(file)
                self._columns = list(reader.fieldnames or self._columns)
                self._rows = [row for row in reader if int(row[STEP]) <= step]
        self._write_all()

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        """Add a row with the numbers that are not excluded from CSV."""
        numbers = {
            key: repr(float(value)) if isinstance(value, float) or hasattr(value, "dtype") else str(value)
            for key, value in sorted(key_values.items())
            if "csv" not in (key_excluded.get(key) or ()) and _is_number(value)
        }
        row = {STEP: str(step), **numbers}
        self._rows.append(row)
        if new := [key for key in numbers if key not in self._columns]:
            self._columns += new
            self._write_all()
            return
        with self._path.open("a", encoding="utf-8", newline="") as file:
            csv.DictWriter(file, self._columns, restval="", lineterminator="\n").writerow(row)

    def close(self) -> None:
        """Do nothing: every row is written already."""

    def _write_all(self) -> None:
        with self._path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, self._columns, restval="", lineterminator="\n")
            writer.writeheader()
            writer.writerows(self._rows)


def _is_number(value: object) -> bool:
    return isinstance(value, bool | int | float) or (hasattr(value, "dtype") and getattr(value, "ndim", 1) == 0)
