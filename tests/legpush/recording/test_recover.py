"""What is left of a recording that was cut off, as a whole one."""

import errno
import os
import random
import re
from pathlib import Path

import pytest
from mcap.reader import make_reader

from legpush.errors import RecordingError
from legpush.messages.telemetry import Fact
from legpush.recording.episodes import read_episodes
from legpush.recording.info import lines
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.recover import recover
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import (
    a_recording,
    damaged,
    traffic,
    write,
)

MISSION = mission(4)
FACT = Fact(name="mission.json", media_type="application/json", data=b'{"seed":1,"policy":"a","policy_sha256":""}')


def test_messages_that_are_missing_in_the_middle_of_what_is_recovered_are_told(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    (path,) = write(tmp_path / "a.mcap", [a for a in actions if a.sequence not in (7, 8)], answers)
    path.write_bytes(path.read_bytes()[:-100])
    stated = recover(path, tmp_path / "b.mcap").completeness
    assert stated["n_missing"] == "2"
    assert "sim/main/action of agent main (agent-1): 2 of 24 messages are missing" in stated["notes"]


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


def test_what_was_damaged_before_it_was_recovered_is_still_told(tmp_path: Path) -> None:
    actions, answers = traffic(MISSION)
    path, out = tmp_path / "a.mcap", tmp_path / "b.mcap"
    write(path, actions, answers, facts=(FACT,))
    damaged(path, actions[5].payload, 40)
    damaged(path, FACT.data)
    path.write_bytes(path.read_bytes()[:-100])
    recover(path, out)
    recording = read_recording([out])
    assert [(each.step, each.field) for each in read_episodes(recording)[0].damage] == [(5, "action")]
    told = "\n".join(lines(recording))
    for words in (
        "1 messages were damaged before it was recovered",
        "damaged: 1 message of sim/main/action (agent main, sequence 5, step 5)",
        "of a.mcap was damaged before it was recovered",
        "agent/main/mission.json was damaged before it was recovered, and is agent/main/mission.json.damaged now",
    ):
        assert words in told
    before = {key: mark for key, mark in recording.marks.items() if key[2] == 5}
    again = tmp_path / "c.mcap"
    out.write_bytes(out.read_bytes()[:-100])
    recover(out, again)
    assert before.items() <= read_recording([again]).marks.items()


def test_a_recording_damaged_in_the_middle_is_recovered_up_to_its_end(tmp_path: Path) -> None:
    path, out = a_recording(tmp_path / "a.mcap", mission(60)), tmp_path / "b.mcap"
    whole, data = read_recording([path]), path.read_bytes()
    begin, end = len(data) // 3, len(data) // 3 + 5000
    path.write_bytes(data[:begin] + bytes(end - begin) + data[end:])
    recover(path, out)
    recording = read_recording([out])
    assert recording.messages[-1] == whole.messages[-1]
    assert 0 < len(whole.messages) - len(recording.messages) < len(whole.messages) / 4
    # The zeros may cover the head of a record, or only lie within a chunk.
    lost = r"could not be read: what was in them is missing|the chunk at byte \d+ of a\.mcap was damaged"
    assert re.search(lost, recording.completeness["notes"])
    assert int(recording.completeness["n_missing"]) == len(whole.messages) - len(recording.messages)


def test_a_whole_recording_is_not_recovered(tmp_path: Path) -> None:
    path, out = a_recording(tmp_path / "a.mcap"), tmp_path / "b.mcap"
    with pytest.raises(RecordingError, match="got a whole one: nothing to recover"):
        recover(path, out)
    assert not out.exists()


def test_a_damaged_summary_is_recovered(tmp_path: Path) -> None:
    path, out = a_recording(tmp_path / "a.mcap"), tmp_path / "b.mcap"
    data = bytearray(path.read_bytes())
    data[-100] ^= 1
    path.write_bytes(data)
    assert read_recording([path]).damaged_records == ["the summary of a.mcap"]
    recover(path, out)
    assert read_recording([out]).damaged_records == []


def test_a_full_disk_leaves_nothing_under_the_name_of_the_new_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, out = a_recording(tmp_path / "a.mcap", mission(60)), tmp_path / "b.mcap"
    path.write_bytes(path.read_bytes()[:-100])
    write_before, left = os.write, [3000]

    def full(file: int, data: bytes) -> int:
        left[0] -= len(data)
        if left[0] < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write_before(file, data)

    monkeypatch.setattr(os, "write", full)
    with pytest.raises(
        RecordingError, match=r"b\.mcap: expected a file that can be written \(No space left on device\)"
    ):
        recover(path, out)
    assert [each.name for each in tmp_path.iterdir()] == ["a.mcap"]


def test_a_file_that_is_there_is_not_replaced(tmp_path: Path) -> None:
    path, out = a_recording(tmp_path / "a.mcap"), tmp_path / "b.mcap"
    path.write_bytes(path.read_bytes()[:-100])
    out.write_bytes(b"mine")
    with pytest.raises(RecordingError, match=r"b.mcap: expected a new file"):
        recover(path, out)
    assert out.read_bytes() == b"mine"
