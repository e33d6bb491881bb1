"""The table of measures: every row with its unit, and only the phases that happened."""

from io import StringIO

import pytest
from msgspec import to_builtins
from msgspec.structs import replace
from rich.console import Console

from legpush.launch.phases_table import PHASE_ROWS, odd_numbers, phases_table
from legpush.runs.report import PhaseReport
from tests.legpush.launch.phases import WALKING


def shown(walking: PhaseReport | None, pushing: PhaseReport | None) -> str:
    table = phases_table({"walking": to_builtins(walking), "pushing": to_builtins(pushing)})
    assert table is not None
    console = Console(file=StringIO(), width=200)
    console.print(table)
    assert isinstance(console.file, StringIO)
    return console.file.getvalue()


def test_each_measure_is_shown_in_a_unit_that_people_read() -> None:
    text = shown(WALKING, replace(WALKING, max_push_moment_n_m=2.54, unexpected=()))
    for value in (
        *("21 / 35 / 50", "18 / 31 / 45", "0.4 / 8.6 / 6.7", "5 / 190 / 92", "0.12 %", "-0.5°", "1504 J", "0.50"),
        *(
            "-0.4 cm",
            "17",
            "2.1 cm",
            "-3.5 cm",
            "2.5 N m",
            "1.04",
            "0.15 m/s",
            "0.9 mm",
            "FL_lower with wall_0",
            "none",
        ),
    ):
        assert value in text
    assert all(title in text for title, _ in PHASE_ROWS.values())


def test_a_row_that_no_phase_has_is_left_out() -> None:
    text = shown(WALKING, None)
    assert "moment" not in text
    assert "pushing" not in text


@pytest.mark.parametrize("report", [{}, {"walking": None, "pushing": None}])
def test_a_report_without_phases_has_no_table(report: dict[str, None]) -> None:
    assert phases_table(report) is None


def test_rows_are_fields_of_a_phase() -> None:
    assert PHASE_ROWS.keys() <= set(PhaseReport.__struct_fields__)


def test_numbers_that_look_wrong_are_explained_unless_the_robot_fell() -> None:
    report = {"walking": to_builtins(WALKING), "pushing": None, "reason": "success"}
    assert len(odd_numbers(report)) == 2
    assert odd_numbers({**report, "reason": "fell"}) == []
    usual = replace(WALKING, n_outside_support=0, min_support_margin_m=0.01, min_capture_margin_m=0.01)
    assert odd_numbers({**report, "walking": to_builtins(usual)}) == []
