"""`legpush study status`: how far a study is, where it ran, and why cells failed."""

from collections import Counter
from collections.abc import Iterator
from typing import Any, Final

from msgspec import Struct

from legpush.study.folder import StudyFolder
from legpush.study.progress import duration

N_FAILURES: Final = 10
"""Most failures to show."""


class Failed(Struct, frozen=True, kw_only=True):
    """A cell that failed."""

    error: str
    inputs: dict[str, Any]


class Status(Struct, frozen=True, kw_only=True):
    """How far a study is."""

    name: str
    kind: str
    code: str
    canary: str | None
    n_cells: int
    n_rows: int
    failures: tuple[Failed, ...]
    cpu_s: float
    wall_s: float
    """Of all cells that have a row."""
    hosts: dict[str, int]
    """Number of rows by host, the most first."""
    failures_file: str
    command: str
    """Goes on with the study."""


def status_of(folder: StudyFolder) -> Status:
    """Return how far a study is.

    Raises:
        ConfigError: It is not the folder of a study.
        RowsError: Rows cannot be read or differ.
    """
    record = folder.record()
    table = folder.rows()
    rows = [] if table is None else table.select(["cell", "host", "cpu_s", "wall_s"]).to_pylist()
    failures = [failure for failure in folder.failures() if failure.cell not in {row["cell"] for row in rows}]
    return Status(
        name=record.name,
        kind=record.kind,
        code=record.code,
        canary=record.canary,
        n_cells=record.n_cells,
        n_rows=len(rows),
        failures=tuple(Failed(error=failure.error, inputs=dict(failure.inputs)) for failure in failures),
        cpu_s=sum(row["cpu_s"] for row in rows),
        wall_s=sum(row["wall_s"] for row in rows),
        hosts=dict(Counter(row["host"] for row in rows).most_common()),
        failures_file=str(folder.failed),
        command=record.command,
    )


def status_lines(status: Status) -> Iterator[str]:
    """Yield lines for people."""
    n_failed = len(status.failures)
    yield f"{status.name}: {status.n_rows} of {status.n_cells} cells of the kind {status.kind}, {n_failed} failed"
    yield f"code {status.code}, canary {status.canary or 'none'}"
    if status.n_rows:
        wall_s, cpu_s = status.wall_s / status.n_rows, status.cpu_s / status.n_rows
        yield f"{duration(status.wall_s)} of cells, {wall_s:.3g} s each, {cpu_s:.3g} s of CPU"
        yield "hosts: " + ", ".join(f"{host} {n}" for host, n in status.hosts.items())
    for failure in status.failures[:N_FAILURES]:
        here = ", ".join(f"{name} = {value!r}" for name, value in failure.inputs.items() if value is not None)
        yield f"failed: {failure.error} ({here})"
    if n_failed > N_FAILURES:
        yield f"and {n_failed - N_FAILURES} more, in {status.failures_file}"
    left = status.n_cells - status.n_rows - n_failed
    if left:
        yield f"{left} cells are missing; to go on: {status.command}"
