"""Prints the end of a run for people: the result of the mission, from `report.json`, and its files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from rich.console import Console
from rich.table import Table
from rich.text import Text

from legpush.errors import one_line
from legpush.launch.phases_table import odd_numbers, phases_table
from legpush.numerics.computed_with import computed_with
from legpush.runs.folder import LOGS, PICTURE_FILE, REPORT_FILE, SCENARIO_FILE, VIDEO_FILE


def _recorded(recording: dict[str, Any]) -> str:
    """Return the file of the recording, and what it lacks."""
    return "; ".join((f"{recording['file']}{', complete' if recording['complete'] else ''}", *recording["notes"]))


def _when(appeared: dict[str, Any]) -> str:
    return f"room.obstacles[{appeared['obstacle']}] at {appeared['time_s']:.1f} s"


def _computed(versions: dict[str, str | None]) -> str:
    """Return what a mission was computed with."""
    motions, numerics = (each or "-" for each in computed_with(versions))
    return f"{numerics}, motions {motions}"


ROWS: Final[dict[str, tuple[str, Callable[[Any], str]]]] = {
    "success": ("mission", lambda done: "success" if done else "no success"),
    "reason": ("reason", str),
    "detail": ("how it ended", str),
    "remedy": ("what would change it", str),
    "box_position_error_m": ("box position error", lambda m: f"{100 * m:.1f} cm"),
    "box_angle_error_deg": ("box angle error", lambda deg: f"{deg:.1f}°"),
    "perceived_box_position_error_m": ("box position error, as perceived", lambda m: f"{100 * m:.1f} cm"),
    "perceived_box_angle_error_deg": ("box angle error, as perceived", lambda deg: f"{deg:.1f}°"),
    "walk_tracking_rms_m": ("walking path error, RMS", lambda m: f"{100 * m:.1f} cm"),
    "box_path_rms_m": ("box path error, RMS", lambda m: f"{100 * m:.1f} cm"),
    "handover_distance_m": ("distance to the box at hand-over", lambda m: f"{m:.2f} m"),
    "trunk_max_abs_pitch_deg": ("trunk pitch, largest", lambda deg: f"{deg:.1f}°"),
    "trunk_max_abs_roll_deg": ("trunk roll, largest", lambda deg: f"{deg:.1f}°"),
    "n_better_paths": ("better paths taken while walking", str),
    "appeared": ("obstacles that appeared", lambda obstacles: ", ".join(map(_when, obstacles)) or "-"),
    "n_replans": ("new paths because of them", str),
    "n_push_cycles": ("push cycles", str),
    "n_footsteps": ("footsteps", str),
    "sim_time_s": ("simulated time", lambda s: f"{s:.1f} s"),
    "wall_time_s": ("wall time, without start, picture and film", lambda s: f"{s:.1f} s"),
    "real_time_factor": ("times real time", lambda factor: f"{factor:.1f}"),
    "state_crc": ("state CRC", str),
    "scenario": ("scenario", str),
    "seed": ("seed", str),
    "policy": ("policy", str),
    "planner": ("planner", str),
    "versions": ("computed with", _computed),
    "recording": ("recording", _recorded),
    "notes": ("note", "; ".join),
}
"""Fields of the report in the order of the table, each with its title and its format."""

NOT_SHOWN: Final = ("command", "scenario_sha256", "numerics", "min_support_margin_m")
"""Fields without a row: they are for programs, or another row or table has them."""
IF_FAILED: Final = ("reason", "detail", "remedy")
"""Rows that say more than the errors of the box only if the mission was no success."""
IF_APPEARED: Final = ("appeared", "n_replans")
"""Rows that are shown only if an obstacle appeared."""
IF_ANY: Final = ("n_better_paths", "notes", "perceived_box_position_error_m", "perceived_box_angle_error_deg")
"""Rows that are shown only if their value is neither 0 nor empty nor None."""

FILES: Final = {
    REPORT_FILE: "these numbers, and the versions of everything",
    PICTURE_FILE: "map, search tree, paths, feet and box",
    VIDEO_FILE: "the mission, filmed",
    SCENARIO_FILE: "the scenario, with every field",
    LOGS: "the log of each process",
}


def print_summary(console: Console, folder: Path, report: dict[str, Any]) -> None:
    """Print a table of the numbers and one of the files that exist; a number that was not measured is a dash."""
    numbers = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    for field, (title, read) in ROWS.items():
        if field in report and _is_shown(field, report):
            value = "-" if report[field] is None else read(report[field])
            numbers.add_row(Text(title, style="dim"), Text(one_line(value), style=_style(field, report)))
    files = Table(box=None, show_header=False, padding=(0, 2, 0, 2))
    for name, what in FILES.items():
        if (folder / name).exists():
            files.add_row(Text(name, style="cyan"), Text(what, style="dim"))
    console.print("", numbers, "", sep="\n")
    if (phases := phases_table(report)) is not None:
        console.print(phases, *(Text(line, style="dim") for line in odd_numbers(report)), "", sep="\n")
    console.print(Text(f"In {folder}:"), soft_wrap=True)
    console.print(files)


def _is_shown(field: str, report: dict[str, Any]) -> bool:
    """Return False for a row about something that did not happen."""
    if field in IF_FAILED:
        return not report["success"] and bool(report[field])
    if field in IF_APPEARED:
        return bool(report.get("appeared"))
    return field not in IF_ANY or bool(report[field])


def _style(field: str, report: dict[str, Any]) -> str:
    """Return the style of a row: success is green, failure red."""
    return "" if field not in ("success", "reason") else "bold green" if report.get("success") else "bold red"
