"""`legpush study status`: how far a study is, where it ran, and why cells failed."""

from collections import Counter
from collections.abc import Iterator
from typing import Final

from legpush.study.folder import StudyFolder
from legpush.study.progress import duration

N_FAILURES: Final = 10
"""Most failures to show."""


def status_lines(folder: StudyFolder) -> Iterator[str]:
    """Yield lines for people.

    Raises:
        ConfigError: It is not the folder of a study.
        RowsError: Rows cannot be read or differ.
    """
    record = folder.record()
    table = folder.rows()
    rows = [] if table is None else table.select(["cell", "host", "cpu_s", "wall_s"]).to_pylist()
    failures = [failure for failure in folder.failures() if failure.cell not in {row["cell"] for row in rows}]
    yield f"{record.name}: {len(rows)} of {record.n_cells} cells of the kind {record.kind}, {len(failures)} failed"
    yield f"code {record.code}, canary {record.canary or 'none'}"
    if rows:
        cpu_s, wall_s = (sum(row[name] for row in rows) for name in ("cpu_s", "wall_s"))
        yield f"{duration(wall_s)} of cells, {wall_s / len(rows):.3g} s each, {cpu_s / len(rows):.3g} s of CPU"
        hosts = Counter(row["host"] for row in rows)
        yield "hosts: " + ", ".join(f"{host} {n}" for host, n in hosts.most_common())
    for failure in failures[:N_FAILURES]:
        here = ", ".join(f"{name} = {value!r}" for name, value in failure.inputs.items() if value is not None)
        yield f"failed: {failure.error} ({here})"
    if len(failures) > N_FAILURES:
        yield f"and {len(failures) - N_FAILURES} more, in {folder.failed}"
    left = record.n_cells - len(rows) - len(failures)
    if left:
        yield f"{left} cells are missing; to go on: {record.command}"
