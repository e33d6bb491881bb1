"""The frames of a journal: whole ones, incomplete ones, and what lies behind a damaged one."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from legpush.errors import JournalError
from legpush.history.journal_file import cut, frame, is_incomplete, is_whole_after, lock, payloads

FIRST, SECOND = b"one" * 20, b"two" * 30


@contextmanager
def holding(path: Path, data: bytes) -> Iterator[int]:
    path.write_bytes(data)
    file = os.open(path, os.O_RDWR)
    try:
        yield file
    finally:
        os.close(file)


def test_payloads_come_in_order_up_to_the_first_that_is_not_whole(tmp_path: Path) -> None:
    first, second = frame(FIRST), frame(SECOND)
    for n_bytes in range(len(first), len(first + second)):
        with holding(tmp_path / "a", (first + second)[:n_bytes]) as file:
            assert list(payloads(file, 0)) == [(FIRST, len(first))]
            assert is_incomplete(file, len(first))
            assert not is_whole_after(file, len(first))
    with holding(tmp_path / "a", first + second) as file:
        assert list(payloads(file, 0)) == [(FIRST, len(first)), (SECOND, len(first + second))]


@pytest.mark.parametrize("at", [0, 5, 20, len(frame(FIRST)) - 1])
def test_a_whole_frame_behind_a_damaged_one_is_found(tmp_path: Path, at: int) -> None:
    first = bytearray(frame(FIRST))
    first[at] ^= 1
    for between in (b"", b"junk", bytes(100)):
        with holding(tmp_path / "a", bytes(first) + between + frame(SECOND) + b"end") as file:
            assert list(payloads(file, 0)) == []
            assert not is_incomplete(file, 0)
            assert is_whole_after(file, 0)
    with holding(tmp_path / "a", bytes(first) + bytes(100)) as file:
        assert not is_whole_after(file, 0)


def test_the_originals_of_files_that_are_cut_are_all_kept(tmp_path: Path) -> None:
    for number, name in enumerate(("a.damaged", "a.damaged-1", "a.damaged-2")):
        data = bytes([number]) * 9
        with holding(tmp_path / "a", data) as file:
            assert cut(tmp_path / "a", file, 4).name == name
        assert (tmp_path / "a").read_bytes() == data[:4]
        assert (tmp_path / name).read_bytes() == data


def test_a_file_is_locked_for_one_process(tmp_path: Path) -> None:
    with holding(tmp_path / "a", b"") as one, holding(tmp_path / "a", b"") as other:
        lock(tmp_path / "a", one)
        with pytest.raises(JournalError, match="in use by another process"):
            lock(tmp_path / "a", other)
