"""Recordings in parts: each a whole file, read in the order of numbers, refused where they do not fit together."""

from pathlib import Path

import pytest
from mcap.reader import make_reader

from legpush.errors import RecordingError
from legpush.messages.telemetry import Fact
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import RecordingFile, Split
from legpush.recording.recover import recover
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import ABOUT, AGENT, traffic, write

FACT = Fact(name="scenario.toml", media_type="application/toml", data=b"x = 1\n")


def test_a_recording_can_be_read_in_parts_each_of_which_is_a_whole_file(tmp_path: Path) -> None:
    actions, answers = traffic(mission(60))
    parts = write(tmp_path / "a.mcap", actions, answers, split=Split(n_bytes=10_000), facts=(FACT,))
    assert len(parts) > 2
    assert [part.name for part in parts[:2]] == ["a-000.mcap", "a-001.mcap"]
    n = 0
    for part in parts:
        with part.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            assert reader.get_summary() is not None
            n += sum(channel.topic.startswith("sim") for _, channel, _ in reader.iter_messages())
            assert len(list(reader.iter_attachments())) == 2
    recording = read_recording(parts)
    assert n == len(recording.messages) == len(actions) + len(answers)
    assert recording.is_complete
    with pytest.raises(RecordingError, match=r"a-002.mcap: expected part 1 of the recording, got part 2"):
        read_recording([parts[0], parts[2]])
    cut, recovered = tmp_path / "cut.mcap", tmp_path / "recovered.mcap"
    cut.write_bytes(parts[1].read_bytes()[:-100])
    stated = recover(cut, recovered).completeness
    assert stated["n_missing"] == "0"
    assert "sim/main/action of agent main (agent-1): 5 messages before the first one here" in stated["notes"]
    assert read_recording([parts[0], recovered, *parts[2:]]).messages == recording.messages


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
        ([parts[0], *other.parts], r"other.mcap: expected another part of the same recording, got one of another"),
        ([parts[1], parts[0], twice], r"twice.mcap: expected each part once, got part 1 again, .*a-001.mcap"),
    ):
        with pytest.raises(RecordingError, match=words):
            read_recording(paths)


@pytest.mark.parametrize("there", ["a-000.mcap", "a-001.mcap", "a-1000.mcap"])
def test_a_later_part_that_is_there_already_is_noticed_at_the_beginning(tmp_path: Path, there: str) -> None:
    (tmp_path / there).touch()
    with pytest.raises(RecordingError, match=f"{there}: expected new files for the parts of a recording") as caught:
        RecordingFile(tmp_path / "a.mcap", ABOUT, Split(seconds=1.0))
    assert caught.value.exit_code == 2
    assert [path.name for path in tmp_path.iterdir()] == [there]
    RecordingFile(tmp_path / "b.mcap", ABOUT, Split(seconds=1.0)).abandon()


def test_parts_without_one_of_them_are_not_complete(tmp_path: Path) -> None:
    actions, answers = traffic(mission(60))
    parts = write(tmp_path / "a.mcap", actions, answers, split=Split(20_000, None))
    assert len(parts) > 2
    assert read_recording(parts).is_complete
    assert not read_recording(parts[1:]).is_complete
