"""The end of a run, for people: every number of the report, and the files that are there."""

import json
from io import StringIO
from pathlib import Path

import pytest
from msgspec import to_builtins
from rich.console import Console

from legpush.launch.phases_table import PHASES
from legpush.launch.summary import IF_FAILED, NOT_SHOWN, ROWS, print_summary
from legpush.runs.report import Report, read_report
from tests.legpush.launch.phases import WALKING

REPORT = {
    "success": True,
    "reason": "success",
    "detail": "the box is at its goal",
    "remedy": "raise `mission.max_push_cycles`",
    "box_position_error_m": 0.0123,
    "box_angle_error_deg": 1.26,
    "perceived_box_position_error_m": 0.021,
    "perceived_box_angle_error_deg": 1.2,
    "walk_tracking_rms_m": None,
    "box_path_rms_m": 0.0084,
    "handover_distance_m": 0.95,
    "trunk_max_abs_pitch_deg": 1.5,
    "trunk_max_abs_roll_deg": 2.5,
    "min_support_margin_m": 0.031,
    "n_better_paths": 2,
    "n_replans": 1,
    "appeared": [{"obstacle": 3, "time_s": 12.0}],
    "n_push_cycles": 17,
    "n_footsteps": 240,
    "sim_time_s": 101.25,
    "wall_time_s": 7.5,
    "real_time_factor": 13.5,
    "state_crc": 123456789,
    "scenario": "corridor",
    "scenario_sha256": "ab" * 32,
    "seed": 3,
    "policy": "variable",
    "planner": "rrt_star",
    "command": "legpush run corridor.toml",
    "numerics": "x86-64-v3/1a2b3c4d",
    "recording": {"file": "mission.mcap", "complete": True, "notes": []},
    "notes": ["no mission.png: it is too dark", "no video: it is too late"],
    "versions": {"legpush": "0.1.0", "numerics": "x86-64-v3/1a2b3c4d", "motions": "2"},
}


def test_the_summary_tells_every_number_and_only_the_files_that_are_there(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text(json.dumps(REPORT))
    (tmp_path / "logs").mkdir()
    console = Console(file=StringIO(), width=200)
    print_summary(console, tmp_path, read_report(tmp_path))
    assert isinstance(console.file, StringIO)
    text = console.file.getvalue()
    for field, (title, _) in ROWS.items():
        assert (title in text) == (field not in IF_FAILED)
    for value in (
        "success",
        "1.2 cm",
        "1.3°",
        "-",
        "0.95 m",
        "corridor",
        "variable",
        "rrt_star",
        "17",
        "101.2 s",
        "13.5",
        "123456789",
        "x86-64-v3/",
    ):
        assert value in text
    assert f"In {tmp_path}:\n  report.json" in text
    assert "  logs" in text
    assert "mission.mp4" not in text


@pytest.mark.parametrize(
    ("appeared", "shown"),
    [
        ([], False),
        ([{"obstacle": 7, "time_s": 6.0}, {"obstacle": 8, "time_s": 65.04}], True),
    ],
)
def test_the_summary_tells_what_appeared_if_anything_did(
    appeared: list[dict[str, float]], shown: bool, tmp_path: Path
) -> None:
    console = Console(file=StringIO(), width=200)
    print_summary(console, tmp_path, {**REPORT, "appeared": appeared, "n_replans": 2})
    assert isinstance(console.file, StringIO)
    text = console.file.getvalue()
    assert ("room.obstacles[7] at 6.0 s, room.obstacles[8] at 65.0 s" in text) == shown
    assert ("new paths because of them" in text) == shown


def test_the_summary_of_a_failure_says_why_and_what_would_change_it(tmp_path: Path) -> None:
    console = Console(file=StringIO(), width=200)
    print_summary(console, tmp_path, {**REPORT, "success": False, "reason": "stuck", "detail": "the box is stuck"})
    assert isinstance(console.file, StringIO)
    text = console.file.getvalue()
    for words in ("no success", "stuck", "the box is stuck", "raise `mission.max_push_cycles`"):
        assert words in text


def test_the_table_shows_every_field_of_a_report() -> None:
    assert {*ROWS, *NOT_SHOWN} == REPORT.keys()
    assert {*ROWS, *NOT_SHOWN, *PHASES} == {*Report.__struct_fields__, "recording"}


def test_the_summary_has_a_table_of_each_phase_that_was_measured(tmp_path: Path) -> None:
    console = Console(file=StringIO(), width=200)
    print_summary(console, tmp_path, {**REPORT, "walking": to_builtins(WALKING), "pushing": None})
    assert isinstance(console.file, StringIO)
    text = console.file.getvalue()
    assert "walking" in text
    assert "pushing" not in text
    assert "cost of transport" in text
