"""The CRCs of data and summary show damage outside of messages, and message indexes are compared with their chunks."""

from pathlib import Path

import pytest
from mcap.opcode import Opcode

from legpush.recording.mcap_file.integrity import Integrity, damaged_indexes
from legpush.recording.mcap_file.records import FRAME, MAGIC, frames
from tests.legpush.recording.recordings import a_recording


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return a_recording(tmp_path / "a.mcap")


def content_of(data: bytes, opcode: int) -> int:
    """Where the content of the first record of this kind begins."""
    at = len(MAGIC)
    while data[at] != opcode:
        at += FRAME.size + FRAME.unpack_from(data, at)[1]
    return at + FRAME.size


def checked(path: Path, at: int | None = None) -> tuple[bool, bool]:
    """Whether data and summary are damaged, after a bit has flipped at this position."""
    data = bytearray(path.read_bytes())
    if at is not None:
        data[at] ^= 1
        path.write_bytes(data)
    integrity = Integrity()
    with path.open("rb") as file:
        file.seek(len(MAGIC))
        for opcode, content in frames(file, len(data)):
            integrity.take(opcode, content)
            if opcode == Opcode.FOOTER:
                break
    return integrity.is_data_damaged, integrity.is_summary_damaged


def test_a_file_as_it_was_written_is_whole(path: Path) -> None:
    assert checked(path) == (False, False)
    assert damaged_indexes(path) == []


@pytest.mark.parametrize(
    "opcode", [Opcode.HEADER, Opcode.METADATA, Opcode.CHUNK, Opcode.MESSAGE_INDEX, Opcode.DATA_END]
)
def test_a_bit_before_the_summary_damages_the_data(path: Path, opcode: int) -> None:
    assert checked(path, content_of(path.read_bytes(), opcode)) == (True, False)


@pytest.mark.parametrize("opcode", [Opcode.STATISTICS, Opcode.CHUNK_INDEX, Opcode.SUMMARY_OFFSET, Opcode.FOOTER])
def test_a_bit_in_the_summary_damages_the_summary(path: Path, opcode: int) -> None:
    assert checked(path, content_of(path.read_bytes(), opcode)) == (False, True)


def test_an_index_that_does_not_fit_its_chunk_is_named_and_that_of_a_damaged_chunk_is_not(path: Path) -> None:
    whole = path.read_bytes()
    chunk = content_of(whole, Opcode.CHUNK) - FRAME.size
    checked(path, content_of(whole, Opcode.MESSAGE_INDEX) + 8)
    assert damaged_indexes(path) == [f"the index of the chunk at byte {chunk}"]
    path.write_bytes(whole)
    checked(path, chunk + 2000)
    assert damaged_indexes(path) == []
