"""Runs a study that a tool makes, and returns its rows."""

from pathlib import Path
from typing import Any

from legpush.errors import LegpushError, StopRequestedError
from legpush.study.carry_out import Orders, carry_out
from legpush.study.file import Study
from legpush.study.folder import StudyFolder


class FailedCellsError(LegpushError):
    """Cells that a tool needs have failed; names one, and where the last words of all are."""


def rows_of_study(study: Study, path: Path, orders: Orders) -> list[dict[str, Any]]:
    """Carry out a study, or go on with it; returns a row for each cell, in the order of the cells.

    Raises:
        StopRequestedError: The stop was set; says how many cells are kept, and how to go on.
        FailedCellsError: A cell failed.
        LegpushError: The study or the engine cannot be used.
    """
    tally = carry_out(study, path, orders)
    if orders.stop.is_set():
        raise StopRequestedError(
            f"interrupted: {tally.n_done} of {tally.n_cells} cells of {study.file.name} are kept; to go on: "
            f"{orders.again}"
        )
    folder = StudyFolder(path)
    if failures := folder.failures():
        raise FailedCellsError(
            f"{len(failures)} of {tally.n_cells} cells of {study.file.name} failed, such as one with "
            f"{failures[0].error}; all have their last words in {folder.failed}"
        )
    table = folder.rows()
    return [] if table is None else table.to_pylist()
