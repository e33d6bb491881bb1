"""Recordings as they are written: what readers of MCAP find in them, parts, and what a full disk leaves."""

import json
import os
from pathlib import Path

import jsonschema
import msgpack
import pytest
from mcap.reader import make_reader

from legpush.errors import RecordingError
from legpush.messages.telemetry import Fact
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import RecordingFile, Split, topic_of
from legpush.recording.recorder import Recorder, Wanted
from legpush.recording.recover import recover
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import ABOUT, AGENT, a_recording, batch, traffic, write

FACT = Fact(name="scenario.toml", media_type="application/toml", data=b"x = 1\n")


def test_readers_of_mcap_find_the_exact_bytes_with_schema_sequence_and_time(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    (path,) = write(tmp_path / "a.mcap", actions, answers, facts=(FACT,))
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        found = {(c.topic, m.sequence): (s, c, m) for s, c, m in reader.iter_messages() if c.topic.startswith("sim")}
        attachments = list(reader.iter_attachments())
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
    assert len(found) == len(actions) + len(answers)
    n_valid = 0
    for each in (*actions, *answers):
        schema, channel, message = found[topic_of(each.key), each.sequence]
        assert message.data == each.payload
        assert message.publish_time == message.log_time == each.time_ns
        assert (channel.message_encoding, channel.metadata["key"]) == ("msgpack", each.key)
        assert schema is not None
        assert schema.encoding == "jsonschema"
        validator = jsonschema.Draft202012Validator(json.loads(schema.data))
        validator.validate(msgpack.unpackb(message.data))
        n_valid += 1
    assert n_valid == 48
    assert {(a.name, a.data) for a in attachments} == {
        ("agent/main/scenario.toml", FACT.data),
        ("sim/main/scenario.toml", FACT.data),
    }
    assert metadata["legpush"]["run"] == "test"
    assert metadata["completeness"] == {"complete": "yes", "n_recorded": "48", "n_missing": "0", "notes": ""}


def test_a_recording_never_replaces_a_file(tmp_path: Path) -> None:
    path = a_recording(tmp_path / "a.mcap")
    before = path.read_bytes()
    with pytest.raises(RecordingError, match="expected a new file for a recording, but there is one"):
        RecordingFile(path, ABOUT)
    with pytest.raises(RecordingError, match="got a whole one: nothing to recover"):
        recover(path, tmp_path / "b.mcap")
    assert path.read_bytes() == before


def test_what_was_flushed_survives_a_disk_that_is_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    actions, _ = traffic(mission())
    file = RecordingFile(tmp_path / "a.mcap", ABOUT)
    recorder = Recorder(file, Wanted())
    recorder.write_batch(batch(AGENT, 0, actions[:10]))
    file.flush()

    def full(descriptor: int, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    recorder.write_batch(batch(AGENT, 1, actions[10:]))
    monkeypatch.setattr(os, "write", full)
    with pytest.raises(RecordingError, match=r"a.mcap: the recording cannot go on \(No space left on device\)"):
        file.flush()
    file.abandon()
    monkeypatch.undo()
    recover(tmp_path / "a.mcap", tmp_path / "b.mcap")
    assert [m.copy for m in read_recording([tmp_path / "b.mcap"]).messages] == actions[:10]


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


@pytest.mark.parametrize("there", ["a-000.mcap", "a-001.mcap", "a-1000.mcap"])
def test_a_later_part_that_is_there_already_is_noticed_at_the_beginning(tmp_path: Path, there: str) -> None:
    (tmp_path / there).touch()
    with pytest.raises(RecordingError, match=f"{there}: expected new files for the parts of a recording") as caught:
        RecordingFile(tmp_path / "a.mcap", ABOUT, Split(seconds=1.0))
    assert caught.value.exit_code == 2
    assert [path.name for path in tmp_path.iterdir()] == [there]
    RecordingFile(tmp_path / "b.mcap", ABOUT, Split(seconds=1.0)).abandon()
