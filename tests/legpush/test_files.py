"""Files are whole or not there, whatever fails, and files that are there are never lost."""

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from legpush.errors import DISK_FULL, code_of
from legpush.files import DiskError, new_file, replace_folder, require_space, sha256_of, write_whole


def contents(folder: Path) -> dict[str, bytes]:
    """What is in a folder, hidden files and those in folders included."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def full_disk(descriptor: int) -> None:
    """In the place of `os.fsync`."""
    raise OSError(28, "No space left on device")


def put(name: str, folder: Path) -> None:
    """Write a file that holds its own name."""
    (folder / name).write_text(name)


def test_a_file_is_written_and_written_again(tmp_path: Path) -> None:
    for data in (b"first", b"second"):
        write_whole(tmp_path / "a", data)
        assert contents(tmp_path) == {"a": data}


def test_a_disk_that_is_full_leaves_the_previous_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_whole(tmp_path / "a", b"first")
    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(DiskError, match=r"a: expected to write 6 bytes \(No space left .*previous one is untouched"):
        write_whole(tmp_path / "a", b"second")
    assert contents(tmp_path) == {"a": b"first"}
    with pytest.raises(DiskError, match=r"b: expected to write 6 bytes \(No space left on device\)$"):
        write_whole(tmp_path / "b", b"second")


def test_a_new_file_has_its_name_when_it_is_whole_and_not_before(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    with new_file(path) as scratch:
        scratch.write_bytes(b"half")
        assert scratch.suffix == ".csv"
        assert not path.exists()
        scratch.write_bytes(b"whole")
    assert contents(tmp_path) == {"a.csv": b"whole"}


def test_after_an_error_there_is_no_new_file_and_nothing_is_left_behind(tmp_path: Path) -> None:
    def write() -> None:
        with new_file(tmp_path / "a") as scratch:
            scratch.write_bytes(b"half")
            raise RuntimeError("halfway")

    with pytest.raises(RuntimeError, match="halfway"):
        write()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("has_links", [True, False])
def test_a_new_file_never_replaces_another(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_links: bool) -> None:
    def no_link(source: Path, target: Path) -> None:
        raise PermissionError(1, "Operation not permitted")

    if not has_links:
        monkeypatch.setattr(os, "link", no_link)
    with new_file(tmp_path / "a") as scratch:
        scratch.write_bytes(b"first")
    with pytest.raises(FileExistsError if has_links else PermissionError), new_file(tmp_path / "a") as scratch:
        scratch.write_bytes(b"second")
    assert contents(tmp_path) == {"a": b"first"}


def test_a_new_file_in_a_folder_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), new_file(tmp_path / "no" / "a"):
        pass


def test_a_folder_is_replaced_as_a_whole(tmp_path: Path) -> None:
    folder = tmp_path / "policy"
    for name in ("first", "second"):
        replace_folder(folder, partial(put, name))
        assert contents(tmp_path) == {f"policy/{name}": name.encode()}


def test_a_folder_that_cannot_be_filled_leaves_the_previous_one(tmp_path: Path) -> None:
    def fill(part: Path) -> None:
        (part / "a").write_bytes(b"second")
        raise OSError(28, "No space left on device")

    folder = tmp_path / "policy"
    folder.mkdir()
    (folder / "a").write_bytes(b"first")
    with pytest.raises(DiskError, match=r"policy: expected to write it \(No space left on device\)"):
        replace_folder(folder, fill)
    assert contents(tmp_path) == {"policy/a": b"first"}


def test_a_full_disk_has_an_exit_code_of_its_own_and_other_errors_have_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(part: Path) -> None:
        full_disk(0)

    require_space(tmp_path)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(DiskError, match="no: expected space for 65536 bytes") as missing:
        require_space(tmp_path / "no")
    assert code_of(missing.value) == 3
    monkeypatch.setattr(os, "fsync", full_disk)
    attempts: list[Callable[[], object]] = [
        lambda: write_whole(tmp_path / "a", b"x"),
        lambda: replace_folder(tmp_path / "b", full),
        lambda: require_space(tmp_path),
    ]
    for attempt in attempts:
        with pytest.raises(DiskError) as caught:
            attempt()
        assert code_of(caught.value) == DISK_FULL


def test_the_digest_is_that_of_all_files_in_order(tmp_path: Path) -> None:
    parts = [tmp_path / name for name in "ab"]
    for part in parts:
        part.write_text(part.name)
    assert sha256_of(parts) == "fb8e20fc2e4c3f248c60c39bd652f3c1347298bb977b8b4d5903b85055620603"
    assert sha256_of(parts[::-1]) != sha256_of(parts)
