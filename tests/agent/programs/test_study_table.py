import io
from pathlib import Path

from msgspec.json import encode
from PIL import Image
from rich.console import Console

from agent_proc.programs.study_table import run
from legpush.options.study import StudyTable
from legpush.study.folder import StudyFolder
from legpush.study.rows import write_part

from ..studies.test_table import RECORD, ROWS


def folder_of(path: Path) -> Path:
    folder = StudyFolder(path)
    folder.make_folders()
    (path / "study.json").write_bytes(encode(RECORD))
    write_part(folder.parts, ROWS[:-1])
    return path


def test_a_table_is_printed_written_and_drawn(tmp_path: Path) -> None:
    folder_of(tmp_path)
    text = io.StringIO()
    options = StudyTable(folder=tmp_path, by=("policy",), csv=tmp_path / "t.csv", plot=tmp_path / "t.png")
    assert run(options, Console(file=text, width=40)) == 0
    lines = text.getvalue().splitlines()
    assert lines[0].split() == ["measure", "policy", "n", "value", "95", "%", "interval", "how"]
    assert lines[1].split()[:4] == ["error_m", "a", "3", "2"]
    assert "7 of 8 cells have a row" in lines
    assert len((tmp_path / "t.csv").read_text().splitlines()) == 5
    with Image.open(tmp_path / "t.png") as picture:
        assert picture.format == "PNG"


def test_differences_are_printed(tmp_path: Path) -> None:
    text = io.StringIO()
    options = StudyTable(folder=folder_of(tmp_path), measure=("error_m",), paired="policy=a")
    assert run(options, Console(file=text, width=200)) == 0
    assert "paired, all values equal of differences" in text.getvalue()
