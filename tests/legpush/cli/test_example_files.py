"""The examples that a user copies."""

from pathlib import Path

import pytest

from legpush.cli import example_files, main
from legpush.cli.example_files import copy_examples
from legpush.errors import ConfigError


def test_all_examples_of_the_checkout_are_copied(tmp_path: Path) -> None:
    source = Path(__file__).parents[3] / "examples"
    made = copy_examples(tmp_path / "mine")
    assert {str(path.relative_to(tmp_path / "mine")) for path in made} == {
        str(path.relative_to(source))
        for path in source.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert (tmp_path / "mine" / "grid_planner.py").read_bytes() == (source / "grid_planner.py").read_bytes()


def test_no_folder_is_written_over(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine").mkdir()
    assert main(["examples", "copy", str(tmp_path / "mine")]) == 2
    assert "Expected a new folder in an existing one for DIR" in capsys.readouterr().err


def test_a_package_without_examples_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(example_files, "__file__", str(tmp_path / "a" / "b" / "c" / "d.py"))
    monkeypatch.setattr(example_files, "_installed", dict)
    with pytest.raises(ConfigError, match="Expected examples beside the package, found none"):
        example_files.example_files()
