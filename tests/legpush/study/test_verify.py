"""`legpush study verify`: what it finds, from the command line."""

import shutil
import threading
from importlib import import_module
from pathlib import Path

import msgspec
import pyarrow
import pytest
from msgspec.structs import replace

from legpush.cli import main
from legpush.errors import INTERRUPTED
from legpush.study.folder import StudyFolder
from legpush.study.rows import write_table

from .parts import STUB

STUDY = """
name = "try"
results = ["value", "odd", "took_s"]
[settings]
factor = 2.0
[axes]
seed = { first = 0, n = 8 }
"""


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study that has been run."""
    path = tmp_path_factory.mktemp("verify")
    (path / "study.toml").write_text(STUDY)
    assert main(["study", "run", str(path / "study.toml"), "--out", str(path / "out"), "--cell", STUB]) == 0
    return path / "out"


@pytest.fixture
def folder(done: Path, tmp_path: Path) -> StudyFolder:
    """A copy of it to alter."""
    shutil.copytree(done, tmp_path / "out")
    return StudyFolder(tmp_path / "out")


def verify(folder: StudyFolder, *more: str) -> int:
    return main(["study", "verify", str(folder.path), "--cell", STUB, "--workers", "1", *more])


def alter(folder: StudyFolder, name: str, place: int, value: object) -> None:
    """Change one number of the table by hand."""
    table = folder.rows()
    assert table is not None
    values = table.column(name).to_pylist()
    values[place] = value
    index = table.column_names.index(name)
    write_table(table.set_column(index, name, pyarrow.array(values)), folder.table)


def test_equal_cells_are_equal(folder: StudyFolder, capsys: pytest.CaptureFixture[str]) -> None:
    assert verify(folder, "--share", "1") == 0
    assert "8 of 8 cells are equal, of 8 in the study" in capsys.readouterr().out
    assert verify(folder) == 0
    assert "1 of 1 cells are equal, of 8" in capsys.readouterr().out


ALTERED = [("value", 6.000001), ("odd", False), ("state_crc", "00000000"), ("factor", 3.0)]


@pytest.mark.parametrize(("name", "value"), ALTERED)
def test_a_number_that_was_altered_by_hand_is_found(
    folder: StudyFolder, capsys: pytest.CaptureFixture[str], name: str, value: object
) -> None:
    alter(folder, name, 3, value)
    assert verify(folder, "--share", "1") == 1
    out = capsys.readouterr().out
    assert f"differs in {name} (stored {value!r}, computed " in out
    assert "7 of 8 cells are equal" in out


def test_seconds_may_differ(folder: StudyFolder) -> None:
    alter(folder, "took_s", 3, 17.0)
    alter(folder, "wall_s", 3, 17.0)
    assert verify(folder, "--share", "1") == 0


def test_a_row_of_no_cell_is_found(folder: StudyFolder, capsys: pytest.CaptureFixture[str]) -> None:
    alter(folder, "cell", 3, "0123")
    assert verify(folder) == 1
    assert "1 rows belong to no cell of the study, such as 0123" in capsys.readouterr().out


def test_another_code_version_is_refused(folder: StudyFolder, capsys: pytest.CaptureFixture[str]) -> None:
    (folder.path / "study.json").write_bytes(msgspec.json.encode(replace(folder.record(), code="0123")))
    assert verify(folder) == 2
    said = capsys.readouterr().err
    assert f"{folder.path}: other version: run by code version 0123 (motion version " in said
    assert "`legpush study table` shows them as before" in said


def test_code_in_the_folder_is_not_run_without_the_users_word(
    folder: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["study", "verify", str(folder.path)]) == 2
    assert "--cell module:function" in capsys.readouterr().err


@pytest.mark.parametrize("share", ["0", "1.5", "-0.1", "nan"])
def test_a_share_out_of_range_is_refused(share: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "verify", "out", "--share", share]) == 2
    assert "for --share, got" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "verify"])
def test_a_head_that_waits_for_a_router_can_be_interrupted(
    command: str, folder: StudyFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stop = threading.Event()
    monkeypatch.setattr(import_module(f"legpush.study.{command}"), "stop_on_signals", lambda: stop)
    (tmp_path / "study.toml").write_text(STUDY)
    what = [str(folder.path)] if command == "verify" else [str(tmp_path / "study.toml"), "--out", str(tmp_path / "new")]
    threading.Timer(0.5, stop.set).start()
    router = f"unixsock-stream/{tmp_path}/nobody.sock"
    assert main(["study", command, *what, "--cell", STUB, "--join", "lab", "--router", router]) == INTERRUPTED
