import shutil
from pathlib import Path
from types import SimpleNamespace

import msgspec
import pytest

from legpush.errors import ConfigError, DiskFullError
from legpush.study.carry_out import study_record
from legpush.study.folder import FailedCell, StudyFolder
from legpush.study.rows import write_part, write_table

from .parts import begun, study_of

OTHER = "[axes]\nseed = [1]\n"


def test_a_study_begins_with_a_copy_of_its_file_and_goes_on_in_its_folder(tmp_path: Path) -> None:
    study = study_of()
    folder = begun(tmp_path / "out", study)
    assert folder.sources() == (study.source,)
    assert folder.record().n_cells == 6
    assert folder.record().axes == ("seed",)
    before = folder.record()
    assert begun(tmp_path / "out", study).record() == before


@pytest.mark.parametrize(
    ("change", "error"),
    [({"code": "0123"}, "another code version"), ({"kind": "push"}, r"another kind of cell \(.*STUB\)")],
)
def test_another_code_or_kind_is_refused(tmp_path: Path, change: dict[str, str], error: str) -> None:
    study = study_of()
    folder = begun(tmp_path, study)
    record = msgspec.structs.replace(folder.record(), cells_sha256="", **change)
    with pytest.raises(ConfigError, match=error), folder.opened((study.source,), record):
        pass


def test_another_study_is_refused_with_what_is_different(tmp_path: Path) -> None:
    begun(tmp_path, study_of())
    with pytest.raises(ConfigError, match="a study file with other axes: results would mix; give another --out"):
        begun(tmp_path, study_of(OTHER))


def test_a_folder_with_other_files_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("")
    with pytest.raises(ConfigError, match=r"or that of this study, got one with thesis\.tex"):
        begun(tmp_path, study_of())


def test_two_heads_cannot_use_one_folder(tmp_path: Path) -> None:
    study = study_of()
    folder = begun(tmp_path, study)
    record = folder.record()
    with (
        folder.opened((study.source,), record),
        pytest.raises(ConfigError, match="another program is using it"),
        StudyFolder(tmp_path).opened((study.source,), record),
    ):
        pass


def test_a_begin_that_was_killed_halfway_begins_again(tmp_path: Path) -> None:
    folder = begun(tmp_path, study_of())
    for leftover in (folder.path / "study.json.part", folder.parts / "a.parquet.part"):
        leftover.write_text("torn")
    (tmp_path / "study.json").unlink()
    shutil.rmtree(folder.parts)
    shutil.rmtree(folder.failed)
    assert begun(tmp_path, study_of()).record().n_cells == 6
    assert [path for path in tmp_path.rglob("*") if path.suffix == ".part"] == []


def test_rows_are_read_from_table_and_parts_alike(tmp_path: Path) -> None:
    folder = begun(tmp_path, study_of())
    assert folder.rows() is None
    write_part(folder.parts, [{"cell": "a", "value": 1.0}])
    table = folder.rows()
    write_table(table, folder.table)
    write_part(folder.parts, [{"cell": "b", "value": 2.0}])
    assert folder.done() == {"a", "b"}
    folder.remove_parts(folder.part_files())
    assert folder.done() == {"a"}


def test_parts_that_are_merged_while_they_are_read_are_read_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = begun(tmp_path, study_of())
    part = write_part(folder.parts, [{"cell": "a", "value": 1.0}])
    listed = [[part, folder.parts / "gone.parquet"], [part]]
    monkeypatch.setattr(folder, "row_files", lambda: listed.pop(0))
    assert folder.done() == {"a"}
    assert listed == []


def test_last_words_are_kept_until_they_are_forgotten(tmp_path: Path) -> None:
    folder = begun(tmp_path, study_of())
    failure = FailedCell(cell="a", inputs={"seed": 1}, own=True, error="ValueError: x", traceback="...", host="h")
    folder.keep_failure(failure)
    assert folder.failures() == [failure]
    folder.forget_failures(["a", "b"])
    assert folder.failures() == []


def test_a_disk_without_space_is_refused_before_anything_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = begun(tmp_path, study_of())
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=20 * 2**20))
    folder.require_space(1000)
    with pytest.raises(DiskFullError, match="expected 26 MiB of space on the disk for 10000 rows, got 20 MiB"):
        folder.require_space(10_000)


def test_what_is_no_study_is_named(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigError, match=r"expected the folder of a study \(.*study\.json: No such file or directory\)$"
    ):
        StudyFolder(tmp_path).record()
    with pytest.raises(ConfigError, match=r"expected the folder of a study, with study\.toml"):
        StudyFolder(tmp_path).sources()


def test_a_canary_is_noted(tmp_path: Path) -> None:
    study = study_of()
    folder = begun(tmp_path, study)
    assert study_record(study, ["a"], "c").canary is None
    folder.set_canary("12345678")
    assert folder.record().canary == "12345678"
