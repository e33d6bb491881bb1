"""Rows of the benchmarks that are studies, in `results/rows/`."""

from collections.abc import Sequence
from typing import Final

from agent_proc.statistics.intervals import median
from benchmarks.report import RESULTS
from experiments.rows import Row, Rows, read_rows

ROWS: Final = RESULTS / "rows"


def rows_of(name: str) -> Rows:
    """Read the rows of a study.

    Raises:
        ConfigError: There are none.
    """
    return read_rows(name, ROWS)


def numbers(rows: Sequence[Row], key: str) -> list[float]:
    """Return the values of a column, without missing ones."""
    return [row[key] for row in rows if row[key] is not None]


def spread(values: Sequence[float], scale: float = 1.0, digits: int = 1) -> str:
    """Format a median and its interval between order statistics; `-` without values."""
    return f"{median(values).scaled(scale):.{digits}f}" if values else "-"
