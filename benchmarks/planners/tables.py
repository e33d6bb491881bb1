"""Tables of results that grow, and medians in them as text."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from time import monotonic
from typing import Any, Final

from rich.progress import track

from agent_proc.statistics.intervals import median
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


def spread(values: Sequence[float], scale: float = 1.0, digits: int = 1) -> str:
    """Format a median and its interval between order statistics for printing; `-` without values."""
    return f"{median(values).scaled(scale):.{digits}f}" if values else "-"
