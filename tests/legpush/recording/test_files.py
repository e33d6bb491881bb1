"""Recordings as files: what readers of MCAP find in them, parts, what is left after a cut, and what is refused."""

import json
import os
import random
from functools import partial
from pathlib import Path

import jsonschema
import msgpack
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from msgspec.structs import replace

from legpush.errors import RecordingError
from legpush.messages.telemetry import Fact, Origin
from legpush.recording.info import lines
from legpush.recording.ledger import Ledger
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import RecordingFile, Split, topic_of
from legpush.recording.recorder import Recorder, Wanted
from legpush.recording.recover import recover
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import ABOUT, ACTIONS, AGENT, SIM, a_recording, batch, copy, traffic, write

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


def test_messages_that_are_missing_in_the_middle_of_what_is_recovered_are_told(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    (path,) = write(tmp_path / "a.mcap", [a for a in actions if a.sequence not in (7, 8)], answers)
    path.write_bytes(path.read_bytes()[:-100])
    stated = recover(path, tmp_path / "b.mcap").completeness
    assert stated["n_missing"] == "2"
    assert "sim/main/action of agent main (agent-1): 2 of 24 messages are missing" in stated["notes"]


def test_a_bit_that_flips_beside_the_messages_is_told(tmp_path: Path) -> None:
    path = a_recording(tmp_path / "a.mcap")
    data, actions = bytearray(path.read_bytes()), traffic(mission())[0]
    data[data.index(actions[5].payload) - 3] ^= 1  # in the time of publishing
    path.write_bytes(data)
    text = "\n".join(lines(read_recording([path])))
    assert "1 pieces of the file have a bit that flipped" in text


def test_a_file_that_is_cut_off_anywhere_is_refused_and_recovered_up_to_the_cut(tmp_path: Path) -> None:
    path = a_recording(tmp_path / "a.mcap", mission(60))
    whole, data = read_recording([path]), path.read_bytes()
    rng = random.Random(3)
    n_recovered = []
    for index, cut in enumerate(sorted(rng.randrange(400, len(data) - 8) for _ in range(40))):
        piece, out = tmp_path / f"{index}.mcap", tmp_path / f"{index}-recovered.mcap"
        piece.write_bytes(data[:cut])
        with pytest.raises(RecordingError, match=f"cut off or damaged at byte .* of {cut}; `legpush recover {piece}`"):
            read_recording([piece])
        recover(piece, out)
        assert piece.read_bytes() == data[:cut]
        recovered = read_recording([out])
        assert recovered.messages == whole.messages[: len(recovered.messages)]
        assert not recovered.is_complete
        assert "was cut off at byte" in recovered.completeness["notes"]
        with out.open("rb") as file:
            assert make_reader(file, validate_crcs=True).get_summary() is not None
        n_recovered.append(len(recovered.messages))
    assert n_recovered == sorted(n_recovered)
    assert n_recovered[0] < n_recovered[-1] == len(whole.messages)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "expected a recording, an MCAP file, got an empty file"),
        (b"not a recording", "got one that begins with b'not a re'"),
        (b"\x89MCAP0\r\n", "one that is cut off before it says what it is"),
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
    with pytest.raises(RecordingError, match="expected a recording of protocol version 6, got one of 5"):
        read_recording(file.parts)


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


def test_a_recording_of_nobody_is_not_complete() -> None:
    assert Ledger().completeness().notes == ("nobody was there to be recorded",)


def test_the_ledger_knows_what_is_missing_and_what_may_be() -> None:
    ledger = Ledger()
    copies = [copy(ACTIONS, sequence, b"a") for sequence in (2, 3, 5)]
    ledger.note_process(SIM)
    ledger.note_batch(batch(AGENT, 0, copies), copies, {ACTIONS})
    found = ledger.completeness()
    assert (found.complete, found.n_recorded, found.n_missing) == (False, 3, 1)
    assert found.notes == (
        "sim main (sim-1) hands over no copies: its messages are missing",
        f"{ACTIONS} of agent main (agent-1): 1 of 4 messages are missing",
        "agent main (agent-1) did not say farewell: its last messages may be missing",
        f"{ACTIONS} of agent main (agent-1): 2 messages before the recording began",
    )


def test_what_came_before_the_recorder_is_not_expected_of_it() -> None:
    ledger = Ledger()
    copies = [copy(ACTIONS, 7, b"a")]
    ledger.note_batch(batch(AGENT, 0, copies), copies, {ACTIONS})
    found = ledger.completeness(live={"agent-1"})
    assert found.complete
    assert found.notes == (f"{ACTIONS} of agent main (agent-1): 7 messages before the recording began",)


def test_a_batch_counts_once_and_a_filter_asks_for_less(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    file = RecordingFile(tmp_path / "a.mcap", ABOUT)
    recorder = Recorder(file, Wanted(topics=("sim/*/action",)))
    for _ in range(2):
        recorder.write_batch(batch(AGENT, 0, actions, final=True))
        recorder.write_batch(batch(SIM, 0, answers, final=True))
    completeness = recorder.ledger.completeness()
    file.finish({})
    assert completeness.complete
    assert completeness.n_recorded == len(actions)
    assert {message.topic for message in read_recording(file.parts).messages} == {"sim/main/action"}


def test_info_says_what_is_there(tmp_path: Path) -> None:
    path = a_recording(tmp_path / "a.mcap")
    text = "\n".join(lines(read_recording([path])))
    for words in ("run test, protocol 6", "complete      yes", "sim/main/action", "24 messages", "steps 0 to 23"):
        assert words in text


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
    assert f"{recording.n_lost} messages that were recorded cannot be read" in text


def test_what_a_planner_and_a_witness_of_it_hand_over_is_recorded_once(tmp_path: Path) -> None:
    planner = Origin(role="planner", name="main", incarnation="planner-1")
    file = RecordingFile(tmp_path / "a.mcap", ABOUT, Split(None, None))
    recorder = Recorder(file, Wanted())
    said = [copy("legpush/v5/test/plan/main/result", sequence, b"a") for sequence in range(5)]
    heard = batch(planner, 0, said[:3])
    recorder.write_batch(replace(heard, header=replace(heard.header, role="agent", incarnation="agent-1")))
    recorder.write_batch(batch(planner, 0, said, final=True))
    found = recorder.ledger.completeness()
    assert (found.complete, found.n_recorded, found.n_missing) == (True, 5, 0)
    file.abandon()


def test_a_report_that_is_damaged_is_no_reason_to_show_nothing(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    report = Fact(name="report.json", media_type="application/json", data=b"[\xff")
    paths = write(tmp_path / "a.mcap", actions, answers, facts=(report,))
    assert "result        cannot be read: report.json is damaged" in lines(read_recording(paths))
