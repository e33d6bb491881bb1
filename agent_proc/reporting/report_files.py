"""Writes the report and the picture of a mission beside its journal."""

import logging
from pathlib import Path
from typing import Final

from agent_proc.endings import MissionResult
from agent_proc.reporting.mission_record import MissionRecord, read_record
from agent_proc.reporting.report import Begun, make_report
from legpush.errors import is_disk_full
from legpush.history.journal import Journal
from legpush.history.steps import read_episode
from legpush.runs import report
from legpush.runs.folder import PICTURE_FILE
from legpush.versions import installed_versions

CLOCK_S: Final = 1e-3
"""Resolution of the time of a file: no mission is reported to be shorter."""

log = logging.getLogger(__name__)


def write_report(folder: Path, journal: Journal, result: MissionResult, begun: Begun, *, picture: bool = True) -> None:
    """Write `report.json`, then `mission.png` if `picture`. A picture that fails becomes a note in the report.

    Raises:
        DiskError: The report cannot be written.
        OSError: The disk is too full for the picture.
    """
    record = read_record(read_episode(journal.path))
    wall_time_s = max(journal.path.stat().st_mtime - journal.opened.began_unix_s, CLOCK_S)
    report.write_report(make_report(record, result, wall_time_s, installed_versions(), begun), folder)
    if picture:
        _draw(record, result, folder)


def _draw(record: MissionRecord, result: MissionResult, folder: Path) -> None:
    """Draw the picture, or note in the report why it could not be drawn."""
    try:
        from agent_proc.reporting.mission_picture.picture import save_picture

        save_picture(record, result, folder / PICTURE_FILE)
    except Exception as error:
        if is_disk_full(error):
            raise
        log.warning("no picture", exc_info=error)
        report.add_note(folder, f"no {PICTURE_FILE}: {type(error).__name__}: {' '.join(str(error).split())}")
