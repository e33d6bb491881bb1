"""A damaged record costs itself at most: reading goes on behind it, with the index of the summary or without."""

import struct
from pathlib import Path

import pytest
from mcap.opcode import Opcode

from legpush.messages.telemetry import Fact
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import Scan, read_recording
from legpush.recording.mcap_file.records import MAGIC
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import traffic, write

FACT = Fact(name="scenario.toml", media_type="text/plain", data=b"x" * 300)
HEAD = struct.Struct("<BQ")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (path,) = write(tmp_path / "a.mcap", *traffic(mission(60)), facts=(FACT,))
    return path


def records(data: bytes, opcode: int) -> list[int]:
    """The positions of all records of this kind."""
    found, at = [], len(MAGIC)
    while at < len(data) - len(MAGIC):
        kind, length = HEAD.unpack_from(data, at)
        found += [at] if kind == opcode else []
        at += HEAD.size + length
    return found


def flipped(data: bytes, at: int, bit: int = 0) -> bytes:
    changed = bytearray(data)
    changed[at] ^= 1 << bit
    return bytes(changed)


def salvaged(path: Path, data: bytes) -> tuple[Recording, Scan]:
    path.write_bytes(data)
    recording, scan = Recording(), Scan(path, salvages=True)
    scan.read_into(recording)
    return recording, scan


def of_chunk(path: Path, data: bytes, chunk: int) -> int:
    """The number of messages in a chunk, digests not counted."""
    path.write_bytes(data[:chunk])
    before, after = Recording(), Recording()
    Scan(path).read_into(before)
    _, length = HEAD.unpack_from(data, chunk)
    path.write_bytes(data[: chunk + HEAD.size + length])
    Scan(path).read_into(after)
    return len(after.messages) - len(before.messages)


@pytest.mark.parametrize("has_summary", [True, False])
@pytest.mark.parametrize("bit", [0, 3, 9, 12, 15, 17, 40])
def test_a_flipped_bit_in_the_length_of_a_chunk_costs_at_most_that_chunk(
    path: Path, tmp_path: Path, bit: int, has_summary: bool
) -> None:
    data = path.read_bytes()
    n_messages = len(read_recording([path]).messages)
    chunks = records(data, Opcode.CHUNK)
    assert len(chunks) > 8
    end = len(data) if has_summary else records(data, Opcode.DATA_END)[0]
    for chunk in (chunks[0], chunks[len(chunks) // 2], chunks[-1]):
        piece = flipped(data[:end], chunk + 1 + bit // 8, bit % 8)
        recording, _ = salvaged(tmp_path / "b.mcap", piece)
        assert len(recording.messages) >= n_messages - of_chunk(tmp_path / "c.mcap", data, chunk)
        assert recording.completeness["complete"] == "yes"


@pytest.mark.parametrize("has_summary", [True, False])
@pytest.mark.parametrize(
    ("opcode", "shift"),
    [
        (Opcode.CHUNK, 0),
        (Opcode.CHUNK, 9 + 8 + 8),
        (Opcode.CHUNK, 9 + 28),
        (Opcode.CHUNK, 9 + 32 + 1),
        (Opcode.CHUNK, 300),
        (Opcode.MESSAGE_INDEX, 2),
        (Opcode.MESSAGE_INDEX, 0),
        (Opcode.ATTACHMENT, 2),
        (Opcode.ATTACHMENT, 40),
        (Opcode.METADATA, 2),
    ],
)
def test_other_damage_costs_at_most_its_record(
    path: Path, tmp_path: Path, opcode: int, shift: int, has_summary: bool
) -> None:
    data = path.read_bytes()
    n_messages = len(read_recording([path]).messages)
    at = records(data, opcode)[-1]
    end = len(data) if has_summary else records(data, Opcode.DATA_END)[0]
    recording, scan = salvaged(tmp_path / "b.mcap", flipped(data[:end], at + shift, 4))
    lost = of_chunk(tmp_path / "c.mcap", data, at) if opcode == Opcode.CHUNK else 0
    assert len(recording.messages) >= n_messages - lost
    assert scan.ended == has_summary


def test_a_block_of_zeros_is_a_gap(path: Path, tmp_path: Path) -> None:
    data = path.read_bytes()
    chunks = records(data, Opcode.CHUNK)
    begin, end = chunks[4], chunks[6]
    for piece in (data, data[: records(data, Opcode.DATA_END)[0]]):
        zeros = piece[:begin] + bytes(end - begin) + piece[end:]
        recording, scan = salvaged(tmp_path / "b.mcap", zeros)
        assert [(gap.begin, gap.end) for gap in scan.gaps] == [(begin, end)]
        lost = sum(of_chunk(tmp_path / "c.mcap", data, chunk) for chunk in (chunks[4], chunks[5]))
        assert len(recording.messages) == len(read_recording([path]).messages) - lost
