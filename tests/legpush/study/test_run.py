"""`legpush study run` from the command line, with real workers."""

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from legpush.cli import main
from legpush.errors import DISK_FULL, INTERRUPTED
from legpush.study import runner
from legpush.study.folder import StudyFolder
from legpush.study.rows import write_part

from .parts import STUB

STUDY = 'name = "try"\n[settings]\n{settings}\n[axes]\nseed = {{ first = 0, n = {n} }}\n'


def study_file(path: Path, n: int, settings: str = "") -> Path:
    file = path / "study.toml"
    file.write_text(STUDY.format(n=n, settings=settings))
    return file


def run(file: Path, out: Path, *more: str) -> int:
    return main(["study", "run", str(file), "--out", str(out), "--cell", STUB, "--workers", "1", *more])


def column(out: Path, name: str) -> list[object]:
    table = StudyFolder(out).rows()
    assert table is not None
    found: list[object] = table.column(name).to_pylist()
    return found


def test_a_study_ends_with_one_table_in_the_order_of_cells(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert run(study_file(tmp_path, 40), out) == 0
    assert column(out, "seed") == list(range(40))
    assert list((out / "parts").iterdir()) == []
    assert "40 of 40 cells; written to" in capsys.readouterr().out
    assert run(study_file(tmp_path, 40), out) == 0
    assert column(out, "seed") == list(range(40))


def test_failed_cells_keep_their_last_words_and_are_run_again_when_asked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, file = tmp_path / "out", study_file(tmp_path, 6, "fail_every = 3")
    assert run(file, out) == 1
    assert column(out, "seed") == [1, 2, 4, 5]
    words = [json.loads(path.read_text()) for path in (out / "failed").iterdir()]
    assert sorted(word["error"] for word in words) == [f"ValueError: seed {n} is a multiple of 3" for n in (0, 3)]
    before = {path.name: path.stat().st_mtime_ns for path in (out / "failed").iterdir()}
    assert run(file, out) == 1
    assert {path.name: path.stat().st_mtime_ns for path in (out / "failed").iterdir()} == before
    assert run(file, out, "--retry-failed") == 1
    assert {path.name: path.stat().st_mtime_ns for path in (out / "failed").iterdir()} != before
    assert "4 of 6 cells, 2 failed" in capsys.readouterr().out


def test_only_the_results_that_are_named_are_kept(tmp_path: Path) -> None:
    file = study_file(tmp_path, 2)
    file.write_text('results = ["odd"]\n' + file.read_text())
    assert run(file, tmp_path / "out") == 0
    table = StudyFolder(tmp_path / "out").rows()
    assert table is not None
    assert "odd" in table.column_names
    assert "value" not in table.column_names


@pytest.mark.parametrize(
    ("more", "error"),
    [
        (["--on", "cluster"], "Expected one of local"),
        (["--workers", "0"], "Expected 1 to 100000 for --workers, got 0"),
    ],
)
def test_bad_options_are_refused_before_the_folder_is_made(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], error: str
) -> None:
    assert run(study_file(tmp_path, 2), tmp_path / "out", *more) == 2
    assert error in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_equal_cells_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "study.toml"
    file.write_text('name = "same"\n[axes]\nseed = [1]\nfactor = [1, 1.0]\n')
    assert run(file, tmp_path / "out") == 2
    assert "expected different" in capsys.readouterr().err


def test_ctrl_c_keeps_what_is_done_and_says_how_to_go_on(tmp_path: Path) -> None:
    out, file = tmp_path / "out", study_file(tmp_path, 200, "seconds = 0.05")
    command = [str(Path(sys.executable).with_name("legpush")), "study", "run", str(file), "--out", str(out)]
    command += ["--cell", STUB]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=dict(os.environ)) as head:
        end_s = time.monotonic() + 60.0
        while not list((out / "parts").glob("*.parquet")) and time.monotonic() < end_s:
            time.sleep(0.1)
        head.send_signal(signal.SIGINT)
        text, _ = head.communicate()
    assert head.returncode == INTERRUPTED
    assert f"to go on: {' '.join(['legpush', *command[1:]])}" in text
    n_done = len(column(out, "seed"))
    assert 0 < n_done < 200
    assert run(file, out) == 0
    assert column(out, "seed") == list(range(200))


def test_a_full_disk_ends_the_study_with_its_own_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out, file, real = tmp_path / "out", study_file(tmp_path, 20), write_part

    def full(folder: Path, rows: list[dict[str, object]]) -> Path:
        monkeypatch.setattr("legpush.files.os.fsync", _no_space)
        return real(folder, rows)

    monkeypatch.setattr(runner, "write_part", full)
    assert run(file, out) == DISK_FULL
    error = capsys.readouterr().err
    assert "No space left on device" in error
    assert "to go on: legpush" in error
    assert list((out / "parts").iterdir()) == []
    monkeypatch.undo()
    assert run(file, out) == 0
    assert column(out, "seed") == list(range(20))


def _no_space(_: int) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
