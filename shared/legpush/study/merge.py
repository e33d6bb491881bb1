"""`legpush study merge`: the rows of several folders as one study."""

from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

import msgspec

from legpush.errors import ConfigError
from legpush.options.checks import require_writable_folder
from legpush.study.folder import StudyFolder
from legpush.study.rows import described, read_rows, write_table


def merge_studies(folders: Sequence[Path], out: Path) -> tuple[int, int]:
    """Write the rows of all folders into a new one; return how many there are, and of how many cells.

    Folders of one study, such as those of several machines, become one folder of that study, which can go on.

    Raises:
        ConfigError: A folder is not one of a study, they differ in kind or code, or `out` is not empty.
        RowsError: Rows cannot be read, or those of a cell differ.
        DiskError: The new folder cannot be written.
    """
    require_writable_folder(out, "--out")
    studies = [StudyFolder(path) for path in folders]
    records = [study.record() for study in studies]
    first = records[0]
    for path, record in zip(folders, records, strict=True):
        for name in ("kind", "code"):
            if getattr(record, name) != getattr(first, name):
                raise ConfigError(
                    f"Expected studies of equal {name}, got {getattr(first, name)} in {folders[0]} and "
                    f"{getattr(record, name)} in {path}"
                )
    if out.exists() and any(out.iterdir()):
        raise ConfigError(f"Expected a new or empty folder for --out, got {out}")
    sources = tuple(dict.fromkeys(source for study in studies for source in study.sources()))
    table = read_rows([file for study in studies for file in study.row_files()], first.may_differ)
    ended: dict[str, set[str]] = {}
    for study, record in zip(studies, records, strict=True):
        ended.setdefault(record.cells_sha256, set()).update(study.done(), (each.cell for each in study.failures()))
    n_missing = sum({record.cells_sha256: record.n_cells for record in records}[key] - len(ended[key]) for key in ended)
    merged = msgspec.structs.replace(
        first,
        name="-".join(dict.fromkeys(record.name for record in records))[:64],
        n_cells=len(set().union(*ended.values())) + n_missing,
        cells_sha256=first.cells_sha256 if len(ended) == 1 else sha256("".join(sorted(ended)).encode()).hexdigest(),
    )
    target = StudyFolder(out)
    with target.opened(sources, merged):
        done = set() if table is None else set(table.column("cell").to_pylist())
        for study in studies:
            for failure in study.failures():
                if failure.cell not in done:
                    target.keep_failure(failure)
        if table is not None:
            about = msgspec.json.encode(merged).decode()
            write_table(described(table, merged.units, about), target.table)
    return len(done), merged.n_cells
