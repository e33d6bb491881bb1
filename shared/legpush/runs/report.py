"""`report.json`: what came out of a mission."""

import json
from pathlib import Path
from typing import Any

from msgspec import Struct, to_builtins

from legpush.errors import LegpushError
from legpush.files import write_whole
from legpush.runs.folder import REPORT_FILE
from legpush.runs.reasons import Reason


class Appeared(Struct, frozen=True, kw_only=True):
    """An obstacle that appeared."""

    obstacle: int
    """Its place in `room.obstacles`, from 0."""
    time_s: float
    """Simulated time since the reset."""


class Report(Struct, frozen=True, kw_only=True):
    """The fields of `report.json`; a number that could not be measured is None."""

    success: bool
    reason: Reason
    """Why the mission ended."""
    detail: str
    """One sentence for people."""
    remedy: str
    """What would change the reason, with the keys of the scenario or the options; empty for a success."""
    box_position_error_m: float
    box_angle_error_deg: float
    walk_tracking_rms_m: float | None
    """Of the distance from the trunk, on the floor, to the path that it followed, over all ticks of gait cycles."""
    box_path_rms_m: float | None
    """Of the distance from the box's centre to the path that it was pushed along, planned or reference, after each
    push cycle."""
    handover_distance_m: float | None
    """From trunk to box where walking handed over to pushing."""
    trunk_max_abs_pitch_deg: float | None
    trunk_max_abs_roll_deg: float | None
    min_support_margin_m: float | None
    """Least distance of the CoM's ground projection from the border of the support polygon; negative outside."""
    n_better_paths: int
    """How often the robot took a better path while it walked."""
    n_replans: int
    """How often an obstacle appeared in the way of robot or box."""
    appeared: tuple[Appeared, ...]
    n_push_cycles: int
    n_footsteps: int
    sim_time_s: float
    wall_time_s: float
    """From the beginning of the journal to its last entry."""
    real_time_factor: float
    """Simulated time by wall time."""
    state_crc: str
    """Of the last state, eight hexadecimal digits: equal missions have equal ones."""
    seed: int
    versions: dict[str, str | None]
    """Of the host that wrote the report; None for what is not installed there."""
    notes: tuple[str, ...] = ()
    """Why there is no picture or no film."""


class ReportError(LegpushError):
    """A mission that ended without a report that can be read; names the file."""


def read_report(folder: Path) -> dict[str, Any]:
    """Read the report that an agent left in the folder of a run.

    Raises:
        ReportError: There is none that can be read.
    """
    path = folder / REPORT_FILE
    try:
        report = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise ReportError(f"{path}: expected the report of the mission ({error})") from error
    if not isinstance(report, dict):
        raise ReportError(f"{path}: expected a JSON object, got {type(report).__name__}")
    return report


def add_note(folder: Path, note: str) -> None:
    """Add a note to the report in the folder of a run, if there is one.

    Raises:
        ReportError: The report cannot be read.
        DiskError: It cannot be written; the previous one is unchanged.
    """
    if (folder / REPORT_FILE).exists():
        report = read_report(folder)
        write_report({**report, "notes": [*report.get("notes", ()), note]}, folder)


def write_report(report: Report | dict[str, Any], folder: Path) -> None:
    """Write `report.json` into the folder of a run.

    Raises:
        DiskError: It cannot be written; the previous one is unchanged.
    """
    write_whole(folder / REPORT_FILE, (json.dumps(to_builtins(report), indent=2) + "\n").encode())
