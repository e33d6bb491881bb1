"""Recordings are MCAP files in every respect: order of records, CRCs, indexes, statistics; whole, in parts, recovered.

`benchmarks/check_recordings.cjs` has another implementation of MCAP judge the same.
"""

import struct
import zlib
from collections import Counter
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

import pytest
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    Footer,
    McapRecord,
    MessageIndex,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.stream_reader import StreamReader, breakup_chunk

from legpush.messages.telemetry import Fact
from legpush.recording.mcap_file.writer import Split
from legpush.recording.recover import recover
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import traffic, write

FACTS = tuple(Fact(name=name, media_type="text/plain", data=name.encode()) for name in ("a.txt", "b.txt"))
MAGIC = b"\x89MCAP0\r\n"


def whole(folder: Path) -> list[Path]:
    return write(folder / "a.mcap", *traffic(mission(60)), facts=FACTS)


def split(folder: Path) -> list[Path]:
    return write(folder / "a.mcap", *traffic(mission(60)), facts=FACTS, split=Split(n_bytes=100_000))


def recovered(folder: Path) -> list[Path]:
    (path,) = whole(folder)
    data = path.read_bytes()
    cut = [folder / f"cut-{share}.mcap" for share in (30, 60, 95)]
    for piece in cut:
        piece.write_bytes(data[: len(data) * int(piece.stem[4:]) // 100])
        recover(piece, folder / f"recovered-{piece.name}")
    return [folder / f"recovered-{piece.name}" for piece in cut]


class Framed(NamedTuple):
    """A record where it stands in the file."""

    opcode: int
    offset: int
    length: int
    """With opcode and length."""
    data: bytes

    def read(self, kind: type[McapRecord]) -> McapRecord:
        stream = ReadDataStream(BytesIO(self.data))
        record: McapRecord = kind.read(stream)  # type: ignore[attr-defined]
        return record


def framed(data: bytes) -> list[Framed]:
    """All records of a file, chunks as such."""
    assert data[:8] == data[-8:] == MAGIC
    found, at = [], 8
    while at < len(data) - 8:
        opcode, length = struct.unpack_from("<BQ", data, at)
        found.append(Framed(opcode, at, 9 + length, data[at + 9 : at + 9 + length]))
        at += 9 + length
    assert at == len(data) - 8
    return found


@pytest.fixture(params=[whole, split, recovered], ids=lambda make: make.__name__)
def files(request: pytest.FixtureRequest, tmp_path: Path) -> list[Path]:
    make: Callable[[Path], list[Path]] = request.param
    made = make(tmp_path)
    assert len(made) > (make is not whole)
    return made


def test_records_come_in_order_and_every_crc_is_right(files: list[Path]) -> None:
    for path in files:
        data = path.read_bytes()
        opcodes = [record.opcode for record in framed(data)]
        end = opcodes.index(Opcode.DATA_END)
        assert opcodes[0] == Opcode.HEADER
        assert opcodes[-1] == Opcode.FOOTER
        of_data = {Opcode.CHUNK, Opcode.MESSAGE_INDEX, Opcode.ATTACHMENT, Opcode.METADATA}
        assert set(opcodes[1:end]) <= of_data
        of_summary = [
            Opcode.SCHEMA,
            Opcode.CHANNEL,
            Opcode.STATISTICS,
            Opcode.CHUNK_INDEX,
            Opcode.ATTACHMENT_INDEX,
            Opcode.METADATA_INDEX,
            Opcode.SUMMARY_OFFSET,
        ]
        groups = list(dict.fromkeys(opcodes[end + 1 : -1]))
        assert groups == [opcode for opcode in of_summary if opcode in groups]
        with path.open("rb") as file:
            assert len(list(StreamReader(file, validate_crcs=True).records)) > len(opcodes) / 2
        attachments = [record for record in framed(data) if record.opcode == Opcode.ATTACHMENT]
        assert len(attachments) == 2 * len(FACTS)
        for record in attachments:
            assert struct.unpack("<I", record.data[-4:])[0] == zlib.crc32(record.data[:-4])


def test_every_index_points_to_what_it_names(files: list[Path]) -> None:
    n_checked: Counter[int] = Counter()
    for path in files:
        data = path.read_bytes()
        records = framed(data)
        at = {record.offset: record for record in records}
        for record in records:
            n_checked[record.opcode] += 1
            match record.opcode:
                case Opcode.CHUNK_INDEX:
                    index = record.read(ChunkIndex)
                    assert isinstance(index, ChunkIndex)
                    chunk = at[index.chunk_start_offset]
                    assert (chunk.opcode, chunk.length) == (Opcode.CHUNK, index.chunk_length)
                    check_message_indexes(index, chunk, at)
                case Opcode.ATTACHMENT_INDEX:
                    named = record.read(AttachmentIndex)
                    assert isinstance(named, AttachmentIndex)
                    attachment = at[named.offset].read(Attachment)
                    assert isinstance(attachment, Attachment)
                    assert (at[named.offset].opcode, at[named.offset].length) == (Opcode.ATTACHMENT, named.length)
                    assert (attachment.name, len(attachment.data)) == (named.name, named.data_size)
                case Opcode.METADATA_INDEX:
                    about = record.read(MetadataIndex)
                    assert isinstance(about, MetadataIndex)
                    assert (at[about.offset].opcode, at[about.offset].length) == (Opcode.METADATA, about.length)
                case Opcode.SUMMARY_OFFSET:
                    group = record.read(SummaryOffset)
                    assert isinstance(group, SummaryOffset)
                    inside = [r for r in records if 0 <= r.offset - group.group_start < group.group_length]
                    assert {r.opcode for r in inside} <= {group.group_opcode}
                    assert sum(r.length for r in inside) == group.group_length
                case Opcode.FOOTER:
                    footer = record.read(Footer)
                    assert isinstance(footer, Footer)
                    summary = data[footer.summary_start : record.offset]
                    assert at[footer.summary_offset_start].opcode == Opcode.SUMMARY_OFFSET
                    assert zlib.crc32(summary + data[record.offset : record.offset + 25]) == footer.summary_crc
                case _:
                    pass
    for opcode in (Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX, Opcode.SUMMARY_OFFSET):
        assert n_checked[opcode] >= len(files)


def check_message_indexes(index: ChunkIndex, chunk: Framed, at: dict[int, Framed]) -> None:
    content = chunk.read(Chunk)
    assert isinstance(content, Chunk)
    found: Counter[int] = Counter()
    for channel, offset in index.message_index_offsets.items():
        entries = at[offset].read(MessageIndex)
        assert isinstance(entries, MessageIndex)
        assert entries.channel_id == channel
        for log_time, where in entries.records:
            opcode, _, of, _, logged = struct.unpack_from("<BQHIQ", content.data, where)
            assert (opcode, of, logged) == (Opcode.MESSAGE, channel, log_time)
            found[channel] += 1
    messages = Counter(m.channel_id for m in breakup_chunk(content, validate_crc=True) if hasattr(m, "channel_id"))
    assert found == messages


def test_the_statistics_are_those_of_the_records(files: list[Path]) -> None:
    for path in files:
        data = path.read_bytes()
        opcodes = Counter(record.opcode for record in framed(data))
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            messages = list(reader.iter_messages())
            summary = reader.get_summary()
        assert summary is not None
        stated = summary.statistics
        assert isinstance(stated, Statistics)
        assert stated.message_count == len(messages)
        assert stated.channel_message_counts == Counter(channel.id for _, channel, _ in messages)
        assert stated.chunk_count == opcodes[Opcode.CHUNK] == opcodes[Opcode.CHUNK_INDEX]
        assert stated.attachment_count == opcodes[Opcode.ATTACHMENT] == opcodes[Opcode.ATTACHMENT_INDEX]
        assert stated.metadata_count == opcodes[Opcode.METADATA] == opcodes[Opcode.METADATA_INDEX]
        assert stated.channel_count == opcodes[Opcode.CHANNEL] == len(summary.channels)
        assert stated.schema_count == opcodes[Opcode.SCHEMA] == len(summary.schemas)
        times = [message.log_time for _, _, message in messages] or [0]
        assert (stated.message_start_time, stated.message_end_time) == (min(times), max(times))
        assert all(isinstance(each, Channel) for each in summary.channels.values())
        assert all(isinstance(each, Schema) for each in summary.schemas.values())
