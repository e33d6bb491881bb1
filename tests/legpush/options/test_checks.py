"""Checks that several commands share."""

import sys
from pathlib import Path

import pytest

from legpush.errors import ConfigError
from legpush.options.checks import program_path, require_new_file, require_writable_file, require_writable_folder


def test_a_new_file_is_one_that_is_not_there_in_a_folder_that_is(tmp_path: Path) -> None:
    require_new_file(tmp_path / "new", "--out")
    (tmp_path / "old").touch()
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    for path in (tmp_path / "old", tmp_path / "dangling", tmp_path / "no" / "new"):
        with pytest.raises(ConfigError, match=f"Expected a new file in an existing folder for --out, got {path}"):
            require_new_file(path, "--out")


def test_a_program_is_found_by_path_or_name() -> None:
    assert program_path(sys.executable) == sys.executable
    assert Path(program_path("sh")).is_absolute()
    with pytest.raises(ConfigError, match="begins with a program, got 'no-such-program', which is not one"):
        program_path("no-such-program")


def test_a_folder_is_writable_if_files_can_be_made_in_it_or_it_can_be_made(tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "new", tmp_path / "new" / "deep"):
        require_writable_folder(folder, "--out")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_below_a_file_or_on_a_system_that_makes_none_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for folder in (tmp_path / "file", tmp_path / "file" / "deep", Path("/proc/new"), Path("/proc")):
        with pytest.raises(ConfigError, match=f"a folder that can be written to for --out, got {folder} \\("):
            require_writable_folder(folder, "--out")


def test_a_file_may_be_replaced_but_not_a_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    require_writable_file(tmp_path / "file", "--json")
    require_writable_file(tmp_path / "new", "--json")
    assert (tmp_path / "file").read_text() == "mine"
    for path in (tmp_path, tmp_path / "no" / "file", tmp_path / "file" / "file"):
        with pytest.raises(ConfigError, match=f"Expected a file in an existing folder for --json, got {path}"):
            require_writable_file(path, "--json")
    with pytest.raises(ConfigError, match=r"a folder that can be written to for --json, got /proc/new \("):
        require_writable_file(Path("/proc/new"), "--json")
