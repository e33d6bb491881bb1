"""Recordings as they are read: whole ones, parts, damaged ones, and what is refused."""

from functools import partial
from pathlib import Path

import pytest
from mcap.writer import Writer

from legpush.errors import RecordingError
from legpush.recording.info import lines
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import RecordingFile, Split
from legpush.recording.recover import recover
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import (
    ABOUT,
    AGENT,
    a_recording,
    damaged,
    traffic,
    write,
)

MISSION = mission(4)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "expected a recording, an MCAP file, got an empty file"),
        (b"not a recording", "got one that begins with b'not a re'"),
        (b"\x89MCAP0\r\n", "one that is cut off before its metadata"),
    ],
)
def test_what_is_no_recording_is_refused(tmp_path: Path, data: bytes, words: str) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(data)
    for read in (partial(read_recording, [path]), partial(recover, path, tmp_path / "b.mcap")):
        with pytest.raises(RecordingError) as caught:
            read()
        assert words in str(caught.value)
        assert "a.mcap" in str(caught.value)
    assert not (tmp_path / "b.mcap").exists()


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"a.mcap: expected a recording that can be read \(No such file"):
        read_recording([tmp_path / "a.mcap"])


def test_an_mcap_file_of_another_program_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(RecordingError, match="got an MCAP file of 'ros2'"):
        read_recording([path])


def test_a_recording_of_another_protocol_version_is_refused(tmp_path: Path) -> None:
    file = RecordingFile(tmp_path / "a.mcap", {**ABOUT, "protocol": "5"})
    file.finish({})
    with pytest.raises(RecordingError, match="expected a recording of protocol version 6, 7, 8, 9 or 10, got one of 5"):
        read_recording(file.parts)


def test_parts_are_read_in_the_order_of_their_numbers_whatever_their_names(tmp_path: Path) -> None:
    actions, _ = traffic(mission())
    paths = [tmp_path / f"a-{number:03d}.mcap" for number in range(998, 1002)]
    for path, action in zip(paths, actions, strict=False):
        file = RecordingFile(path, ABOUT, part=int(path.stem[2:]))
        file.write(AGENT, (action,))
        file.finish({})
    as_in_a_shell = sorted(paths)
    assert [path.name for path in as_in_a_shell] == ["a-1000.mcap", "a-1001.mcap", "a-998.mcap", "a-999.mcap"]
    recording = read_recording(as_in_a_shell)
    assert recording.files == paths
    assert [message.copy for message in recording.messages] == actions[: len(paths)]


def test_parts_that_are_missing_foreign_or_there_twice_are_refused(tmp_path: Path) -> None:
    actions, answers = traffic(mission(60))
    parts = write(tmp_path / "a.mcap", actions, answers, split=Split(n_bytes=20_000))
    other = RecordingFile(tmp_path / "other.mcap", {**ABOUT, "run": "other"}, part=1)
    other.finish({})
    twice = tmp_path / "twice.mcap"
    twice.write_bytes(parts[1].read_bytes())
    assert len(parts) > 3
    for paths, words in (
        ([parts[3], parts[1], parts[0]], r"a-003.mcap: expected part 2 of the recording, got part 3"),
        (
            [parts[0], *other.parts],
            r"other.mcap: expected another part of the same recording, got a part of another one",
        ),
        ([parts[1], parts[0], twice], r"twice.mcap: expected each part once, got part 1 again, .*a-001.mcap"),
    ):
        with pytest.raises(RecordingError, match=words):
            read_recording(paths)


def test_parts_without_one_of_them_are_not_complete(tmp_path: Path) -> None:
    actions, answers = traffic(mission(60))
    parts = write(tmp_path / "a.mcap", actions, answers, split=Split(20_000, None))
    assert len(parts) > 2
    assert read_recording(parts).is_complete
    assert not read_recording(parts[1:]).is_complete


def test_a_message_whose_channel_is_not_known_is_missed_and_others_are_read(tmp_path: Path) -> None:
    actions, answers = traffic(MISSION)
    (path,) = write(tmp_path / "a.mcap", actions, answers)
    recording = damaged(path, actions[5].payload, -21)
    assert (recording.n_lost, len(recording.damaged_records)) == (1, 1)
    assert len(recording.messages) == len(actions) + len(answers) - 1


def test_messages_that_a_damaged_length_hides_are_missed(tmp_path: Path) -> None:
    path = a_recording(tmp_path / "a.mcap")
    whole = path.read_bytes()
    actions, _ = traffic(mission())
    payload = next(each.payload for each in actions if each.sequence == len(actions) - 2)
    at = whole.index(payload) - 22 - 8
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(whole[:at] + bytes([whole[at] ^ 0x40]) + whole[at + 1 :])
    recording = read_recording((damaged,))
    assert recording.n_lost > 0
    assert not recording.is_complete
    text = "\n".join(lines(recording))
    assert f"damaged: {recording.n_lost} messages that cannot be read any more" in text
