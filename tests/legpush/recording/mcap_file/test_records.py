"""Records of an MCAP file, one by one: whole, cut off, of other kinds, and damaged."""

import struct
from io import BytesIO

from mcap.opcode import Opcode
from mcap.records import Metadata

from legpush.messages import codec
from legpush.recording.mcap_file.records import frames, is_attachment_whole, is_read, parsed


def framed(opcode: int, data: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(data)) + data


def text(value: bytes) -> bytes:
    return struct.pack("<I", len(value)) + value


METADATA = text(b"legpush") + struct.pack("<I", 0)


def test_records_come_one_by_one_up_to_the_first_that_is_cut_off() -> None:
    whole = framed(1, b"abc") + framed(2, b"")
    for n_more in range(len(framed(3, b"xyz"))):
        data = whole + framed(3, b"xyz")[:n_more]
        assert list(frames(BytesIO(data), len(data))) == [(1, b"abc"), (2, b"")]


def test_a_length_beyond_the_end_of_the_file_is_not_believed() -> None:
    data = framed(1, b"abc") + struct.pack("<BQ", 2, 2**60)
    assert list(frames(BytesIO(data), len(data))) == [(1, b"abc")]


def test_a_record_that_is_read_here_is_parsed_and_a_damaged_one_is_none() -> None:
    record = parsed(Opcode.METADATA, METADATA)
    assert isinstance(record, Metadata)
    assert (record.name, record.metadata) == ("legpush", {})
    for damaged in (METADATA[:3], text(b"\xff\xff") + METADATA[11:], struct.pack("<I", 2**31) + METADATA[4:]):
        assert parsed(Opcode.METADATA, damaged) is None


def test_records_of_other_kinds_are_none_as_well_and_no_damage() -> None:
    assert parsed(Opcode.STATISTICS, b"") is None
    assert not is_read(Opcode.STATISTICS)
    assert is_read(Opcode.CHUNK)


def test_an_attachment_is_whole_if_its_checksum_fits() -> None:
    data = b"attachment"
    whole = data + struct.pack("<I", codec.checksum(data))
    assert is_attachment_whole(whole)
    assert not is_attachment_whole(b"A" + whole[1:])
