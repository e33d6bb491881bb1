from pathlib import Path

import msgspec
import pytest

from legpush.cli import main
from legpush.errors import ConfigError
from legpush.study.folder import FailedCell, StudyFolder
from legpush.study.merge import merge_studies
from legpush.study.rows import RowsError, write_part

from .parts import begun, study_of

WIDER = "[axes]\nseed = { first = 4, n = 6 }\n"


def with_rows(path: Path, text: str, places: list[int], **more: object) -> StudyFolder:
    study = study_of(text)
    folder = begun(path, study)
    rows = [{"cell": study.task(place).cell, "seed": study.task(place).inputs["seed"], **more} for place in places]
    write_part(folder.parts, rows)
    return folder


SAME = "[axes]\nseed = { first = 0, n = 6 }\n"


def test_two_halves_of_a_study_become_that_study(tmp_path: Path) -> None:
    a, b = with_rows(tmp_path / "a", SAME, [0, 1, 2]), with_rows(tmp_path / "b", SAME, [2, 3])
    assert merge_studies([a.path, b.path], tmp_path / "c") == (4, 6)
    merged = StudyFolder(tmp_path / "c")
    assert merged.record() == a.record()
    assert len(merged.done()) == 4
    assert begun(tmp_path / "c", study_of(SAME)).record().n_cells == 6


def test_two_studies_become_one_with_both_files(tmp_path: Path) -> None:
    a, b = with_rows(tmp_path / "a", SAME, [0, 4, 5]), with_rows(tmp_path / "b", WIDER, [0, 1, 2, 3, 4, 5])
    a.keep_failure(FailedCell(cell="gone", inputs={}, own=True, error="no"))
    assert merge_studies([a.path, b.path], tmp_path / "c") == (7, 10)
    merged = StudyFolder(tmp_path / "c")
    assert merged.sources() == (*a.sources(), *b.sources())
    assert [failure.cell for failure in merged.failures()] == ["gone"]
    with pytest.raises(ConfigError, match="got one with 2 merged studies"):
        begun(tmp_path / "c", study_of(SAME))


def test_rows_that_contradict_each_other_are_named(tmp_path: Path) -> None:
    a, b = with_rows(tmp_path / "a", SAME, [0], value=1.0), with_rows(tmp_path / "b", SAME, [0], value=2.0)
    with pytest.raises(RowsError, match="got different value"):
        merge_studies([a.path, b.path], tmp_path / "c")
    assert not (tmp_path / "c").exists()


@pytest.mark.parametrize("name", ["kind", "code"])
def test_studies_of_other_code_or_kind_are_refused(tmp_path: Path, name: str) -> None:
    a, b = with_rows(tmp_path / "a", SAME, [0]), with_rows(tmp_path / "b", SAME, [1])
    record = msgspec.structs.replace(b.record(), **{name: "other"})
    (b.path / "study.json").write_bytes(msgspec.json.encode(record))
    with pytest.raises(ConfigError, match=f"Expected studies of equal {name}"):
        merge_studies([a.path, b.path], tmp_path / "c")


def test_the_command_makes_a_folder_beside_the_first_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b = with_rows(tmp_path / "a", SAME, [0]), with_rows(tmp_path / "b", SAME, [1])
    assert main(["study", "merge", str(a.path), str(b.path)]) == 0
    assert f"2 of 6 cells; written to {tmp_path / 'a-merged'}" in capsys.readouterr().out
    assert main(["study", "merge", str(a.path), str(b.path)]) == 2
    assert "Expected a new or empty folder for --out" in capsys.readouterr().err
