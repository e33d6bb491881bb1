"""A file that keeps its first error for those who ask."""

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NoReturn

import pytest

from sim_proc.export.steady_file import SteadyFile


def full(*_: object) -> NoReturn:
    raise OSError(28, "No space left on device")


@pytest.fixture
def on_a_full_disk() -> Any:
    """A path whose file takes nothing."""
    return SimpleNamespace(open=lambda _: SimpleNamespace(write=full, flush=full, seek=full, close=lambda: None))


def test_what_is_written_is_in_the_file_and_can_be_overwritten(tmp_path: Path) -> None:
    with SteadyFile(tmp_path / "a") as file:
        assert file.write(b"hello world") == 11
        assert file.seek(6) == 6
        assert file.write(b"W") == 1
        assert file.seek(0, os.SEEK_END) == 11
        assert file.seek(-1, os.SEEK_CUR) == 10
        file.flush()
        file.check()
    assert (tmp_path / "a").read_bytes() == b"hello World"


def test_an_existing_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"kept")
    with pytest.raises(FileExistsError):
        SteadyFile(tmp_path / "a")
    assert (tmp_path / "a").read_bytes() == b"kept"


def test_an_error_is_kept_for_check_while_writing_seems_to_go_on(on_a_full_disk: Any) -> None:
    file = SteadyFile(on_a_full_disk)
    file.check()
    assert file.write(b"hello") == 5
    assert file.seek(0, os.SEEK_END) == 5
    file.flush()
    with pytest.raises(OSError, match="No space left"):
        file.check()


def test_an_error_that_nobody_asked_for_is_raised_at_the_end(on_a_full_disk: Any) -> None:
    with pytest.raises(OSError, match="No space left"), SteadyFile(on_a_full_disk) as file:
        file.write(b"hello")


def test_another_error_is_not_hidden_by_that_of_the_file(on_a_full_disk: Any) -> None:
    file = SteadyFile(on_a_full_disk)
    file.write(b"hello")
    with pytest.raises(KeyError), file:
        raise KeyError
