import sys
from pathlib import Path

import pytest

from legpush.cli import main
from legpush.study.folder import FailedCell
from legpush.study.rows import write_part
from legpush.study.status import status_lines, status_of

from .parts import begun, study_of


def test_a_status_has_rows_failures_and_the_way_on(tmp_path: Path) -> None:
    folder = begun(tmp_path, study_of())
    assert next(iter(status_lines(status_of(folder)))).startswith("stub: 0 of 6 cells of the kind ")
    write_part(folder.parts, [{"cell": cell, "host": "a", "cpu_s": 1.0, "wall_s": 2.0} for cell in "xyz"])
    folder.keep_failure(FailedCell(cell="f", inputs={"seed": 4, "planner": None}, own=True, error="ValueError: no"))
    folder.keep_failure(FailedCell(cell="x", inputs={"seed": 5}, own=False, error="lost before"))
    text = "\n".join(status_lines(status_of(folder)))
    assert "stub: 3 of 6 cells" in text
    assert ", 1 failed" in text
    assert "6 s of cells, 2 s each, 1 s of CPU" in text
    assert "hosts: a 3" in text
    assert "failed: ValueError: no (seed = 4)" in text
    assert "2 cells are missing; to go on: legpush study run" in text


def test_many_failures_are_not_all_shown(tmp_path: Path) -> None:
    folder = begun(tmp_path, study_of())
    for index in range(12):
        folder.keep_failure(FailedCell(cell=f"{index}", inputs={}, own=True, error="no"))
    assert f"and 2 more, in {folder.failed}" in list(status_lines(status_of(folder)))


def test_a_missing_library_is_named_with_the_extra_that_has_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [
        name for name in sys.modules if name.partition(".")[0] == "pyarrow" or name.startswith("legpush.study")
    ]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert main(["study", "status", str(tmp_path)]) == 2
    assert "which is not installed; pip install 'legpush[agent]' installs it" in capsys.readouterr().err


def test_what_is_no_study_ends_with_code_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "status", str(tmp_path)]) == 2
    assert "expected the folder of a study" in capsys.readouterr().err
