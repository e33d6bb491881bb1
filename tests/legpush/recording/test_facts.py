"""What a recording knows of its mission, and when it cannot be run again."""

from pathlib import Path

import pytest

from legpush.errors import RecordingError
from legpush.messages.telemetry import Fact
from legpush.recording.facts import CONTINUED, read_facts, recorded_with, unpack_mission
from legpush.recording.info import lines
from legpush.recording.mcap_file.reader import read_recording
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import (
    a_recording,
    damaged,
    traffic,
    write,
)

MISSION = mission(4)
FACT = Fact(name="mission.json", media_type="application/json", data=b'{"seed":1,"policy":"a","policy_sha256":""}')


def test_a_recording_that_is_no_mission_cannot_be_run_again(tmp_path: Path) -> None:
    recording = read_recording([a_recording(tmp_path / "a.mcap")])
    with pytest.raises(RecordingError, match=r"with mission.json in it, got one with no files"):
        read_facts(recording)
    recording.about |= {"parent_sha256": "0", "parent_file": "p.mcap", "parent_episode": "0", "parent_step": "3"}
    with pytest.raises(RecordingError, match=r"got a branch of p.mcap at 0:3; it can be verified"):
        unpack_mission(recording, tmp_path)


def test_a_mission_that_was_interrupted_says_so_and_cannot_be_run_again_from_its_second_recording(
    tmp_path: Path,
) -> None:
    recording = read_recording([a_recording(tmp_path / "a.mcap")])
    assert not any("after an interruption" in line for line in lines(recording))
    recording.about |= {CONTINUED: "yes"}
    assert any("began         after an interruption" in line for line in lines(recording))
    with pytest.raises(RecordingError, match="from its beginning on, got one that goes on after an interruption"):
        unpack_mission(recording, tmp_path)


def test_a_file_in_the_recording_that_is_damaged_is_told_and_refused_where_it_is_needed(tmp_path: Path) -> None:
    (path,) = write(tmp_path / "a.mcap", *traffic(MISSION), facts=(FACT,))
    assert read_facts(read_recording([path])).policy == "a"
    n_damaged = 0
    for shift in range(-40, len(FACT.data) + 4):
        data = bytearray(path.read_bytes())
        data[data.index(FACT.data) + shift] ^= 4
        other = tmp_path / "damaged.mcap"
        other.write_bytes(data)
        recording = read_recording([other])
        n_damaged += len(recording.damaged_attachments) == 1 or len(recording.damaged_records) == 1
    assert n_damaged == len(FACT.data) + 44
    recording = damaged(path, FACT.data, 9)
    assert recording.damaged_attachments == {"agent/main/mission.json"}
    assert "damaged: the file agent/main/mission.json" in "\n".join(lines(recording))
    with pytest.raises(RecordingError, match=r"agent/main/mission.json of the recording is damaged"):
        read_facts(recording)


@pytest.mark.parametrize("policy", ["", "--trust-policy-file", "a\\u0000b", "a\\u001b[2Jb", "a\\n"])
def test_the_name_of_a_policy_that_is_a_flag_or_has_control_characters_is_refused(tmp_path: Path, policy: str) -> None:
    data = f'{{"seed":1,"policy":"{policy}","policy_sha256":""}}'.encode()
    fact = Fact(name="mission.json", media_type="application/json", data=data)
    recording = read_recording(write(tmp_path / "a.mcap", *traffic(MISSION), facts=(fact,)))
    with pytest.raises(RecordingError, match=r"mission\.json of the recording: .*policy"):
        read_facts(recording)
    assert any("policy        cannot be read" in line for line in lines(recording))


AGENT_NOTED = b'{"numerics":"native/1","motions":"1"}'
SIMULATOR_NOTED = b'{"name":"x86-64-v3/2","motions":"7","versions":{}}'


@pytest.mark.parametrize(
    ("noted", "motions", "numerics"),
    [
        ({}, None, None),
        ({"versions.json": b'{"numpy":"2.4.6"}'}, None, None),
        ({"versions.json": b'{"numerics":"native/1"}'}, None, "native/1"),
        ({"versions.json": AGENT_NOTED}, "1", "native/1"),
        ({"versions.json": AGENT_NOTED, "numerics.json": b'{"name":"x86-64-v3/2"}'}, "1", "x86-64-v3/2"),
        ({"versions.json": AGENT_NOTED, "numerics.json": SIMULATOR_NOTED}, "7", "x86-64-v3/2"),
    ],
)
def test_what_the_simulator_noted_counts_before_what_the_agent_did(
    tmp_path: Path, noted: dict[str, bytes], motions: str | None, numerics: str | None
) -> None:
    facts = tuple(Fact(name=name, media_type="application/json", data=data) for name, data in noted.items())
    (path,) = write(tmp_path / "a.mcap", *traffic(MISSION), facts=facts)
    recording = read_recording([path])
    assert recorded_with(recording) == (motions, numerics)
    shown = list(lines(recording))
    assert f"numerics      {numerics or 'not noted'}" in shown
    assert f"motions       {'not noted' if motions is None else f'version {motions}'}" in shown
    assert any("other version: recorded" in line for line in shown)


def test_numerics_that_cannot_be_read_are_told(tmp_path: Path) -> None:
    (path,) = write(
        tmp_path / "a.mcap", *traffic(MISSION), facts=(Fact(name="numerics.json", media_type="a", data=b"{"),)
    )
    with pytest.raises(RecordingError, match=r"numerics.json of the recording: "):
        recorded_with(read_recording([path]))
