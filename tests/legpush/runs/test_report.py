"""The report of a mission, as others read it."""

from pathlib import Path

import pytest

from legpush.runs.report import ReportError, add_note, read_report


def test_a_report_is_read_as_it_was_written(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text('{"success": true, "n_push_cycles": 17}')
    assert read_report(tmp_path) == {"success": True, "n_push_cycles": 17}


@pytest.mark.parametrize(
    ("content", "words"), [(None, "No such file"), ("{", "Expecting"), ("[]", "JSON object, got list")]
)
def test_a_report_that_cannot_be_read_is_named(content: str | None, words: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "report.json").write_text(content)
    with pytest.raises(ReportError, match=rf"report\.json: expected .*{words}"):
        read_report(tmp_path)


def test_notes_are_added_to_a_report_and_make_none(tmp_path: Path) -> None:
    add_note(tmp_path, "no picture")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "report.json").write_text('{"success": true}')
    add_note(tmp_path, "no picture")
    add_note(tmp_path, "no film")
    assert read_report(tmp_path) == {"success": True, "notes": ["no picture", "no film"]}
