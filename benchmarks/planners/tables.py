"""Tables of results that grow, and intervals of medians."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from time import monotonic
from typing import Any, Final

import numpy as np
from rich.progress import track

from experiments.evaluations import read_table, write_table

RESULTS: Final = Path(__file__).parent.parent / "results"
SAVED_EVERY_S: Final = 20.0

Row = dict[str, Any]


def fill(path: Path, keys: Sequence[str], wanted: Iterable[tuple[Any, ...]], measure: Callable[..., Row]) -> list[Row]:
    """Return the wanted rows of a table; missing rows are measured and saved on the way.

    `keys` are the columns that identify a row; `measure` takes their values.
    """
    rows: dict[tuple[str, ...], Row] = {tuple(row[key] for key in keys): dict(row) for row in read_table(path)}
    missing = [values for values in wanted if tuple(map(str, values)) not in rows]
    saved_at_s = monotonic()
    for values in track(missing, description=path.name.partition(".")[0]):
        rows[tuple(map(str, values))] = {**dict(zip(keys, values, strict=True)), **measure(*values)}
        if monotonic() - saved_at_s > SAVED_EVERY_S:
            write_table(list(rows.values()), path)
            saved_at_s = monotonic()
    if missing:
        write_table(list(rows.values()), path)
    return [{key: str(value) for key, value in row.items()} for row in rows.values()]


def numbers(rows: Iterable[Row], key: str) -> list[float]:
    """Return the values of a column, without empty ones."""
    return [float(row[key]) for row in rows if row[key] not in ("", "None")]


def median_interval(values: Sequence[float]) -> tuple[float, float, float]:
    """Return a median and its 95 % percentile bootstrap interval, drawn with a fixed seed."""
    data = np.array(values)
    drawn = np.random.default_rng(0).integers(len(data), size=(2000, len(data)))
    low, high = np.quantile(np.median(data[drawn], axis=1), (0.025, 0.975)).tolist()
    return float(np.median(data)), low, high


def spread(values: Sequence[float], scale: float = 1.0, digits: int = 1) -> str:
    """Format a median and its interval for printing."""
    if not values:
        return "-"
    median, low, high = (scale * value for value in median_interval(values))
    return f"{median:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"
