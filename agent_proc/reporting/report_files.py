"""Writes the report and the picture of a mission beside its journal."""

import json
from pathlib import Path
from typing import Final

import msgspec

from agent_proc.endings import MissionResult
from agent_proc.reporting.mission_record import read_record
from agent_proc.reporting.report import make_report
from legpush.files import write_whole
from legpush.history.journal import Journal
from legpush.history.steps import read_episode
from legpush.runs.folder import PICTURE_FILE, REPORT_FILE
from legpush.versions import installed_versions

CLOCK_S: Final = 1e-3
"""Resolution of the time of a file: no mission is reported to be shorter."""


def write_report(folder: Path, journal: Journal, result: MissionResult, *, picture: bool = True) -> None:
    """Write `mission.png` if `picture`, then `report.json`: a folder with a report has everything.

    Raises:
        DiskError: The report cannot be written.
    """
    record = read_record(read_episode(journal.path))
    wall_time_s = max(journal.path.stat().st_mtime - journal.opened.began_unix_s, CLOCK_S)
    report = make_report(record, result, wall_time_s, installed_versions())
    if picture:
        from agent_proc.reporting.picture import save_picture

        save_picture(record, result, folder / PICTURE_FILE)
    write_whole(folder / REPORT_FILE, (json.dumps(msgspec.to_builtins(report), indent=2) + "\n").encode())
