"""Checks that several commands share."""

import sys
from pathlib import Path

import pytest

from legpush.errors import ConfigError
from legpush.options.checks import program_path, require_new_file


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
