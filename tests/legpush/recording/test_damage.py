"""Bits that flip in a recording: each is told, and where it is, in the file itself and in what is recovered from it."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.errors import RecordingError
from legpush.messages import codec
from legpush.messages.stepping import Action, Observation
from legpush.messages.telemetry import Copy, Fact
from legpush.recording.episodes import read_episodes
from legpush.recording.facts import read_facts
from legpush.recording.info import lines
from legpush.recording.mcap_file.reader import Recorded, Recording, read_recording
from legpush.recording.recover import recover
from legpush.recording.verify import verify
from tests.legpush.fakes import FakeStepper, mission
from tests.legpush.recording.recordings import ACTIONS, AGENT, ANSWERS, EPISODE, SIM, copy, header, traffic, write

MISSION = mission(4)
RESENT = 3
"""Step of the second episode whose action is sent once more."""
FACT = Fact(name="mission.json", media_type="application/json", data=b'{"seed":1,"policy":"a","policy_sha256":""}')


def two_episodes() -> tuple[list[Copy], list[Copy]]:
    """The mission twice, in the second episode with an action that is sent again right away."""
    actions, answers = traffic(MISSION)
    for action, answer in zip(*traffic(MISSION), strict=True):
        asked = replace(codec.decode(action.payload, Action), episode=EPISODE + 1)
        told = replace(codec.decode(answer.payload, Observation), episode=EPISODE + 1)
        for _ in range(2 if asked.step == RESENT else 1):
            n = len(actions)
            actions.append(copy(ACTIONS, n, codec.encode(replace(asked, header=header(AGENT, n)))))
        n = len(answers)
        answers.append(copy(ANSWERS, n, codec.encode(replace(told, header=header(SIM, n)))))
    return actions, answers


@pytest.mark.parametrize(
    ("what", "index", "episode", "step"),
    [
        ("action", 5, 0, 5),
        ("action", 0, 0, 0),
        ("action", len(MISSION), 1, 0),
        ("action", len(MISSION) + RESENT + 1, 1, RESENT),
        ("observation", len(MISSION) + 5, 1, 5),
    ],
)
def test_a_byte_that_changes_anywhere_in_a_message_is_found_at_its_step(
    tmp_path: Path, what: str, index: int, episode: int, step: int
) -> None:
    actions, answers = two_episodes()
    (path,) = write(tmp_path / "a.mcap", actions, answers)
    payload = (actions if what == "action" else answers)[index].payload
    whole, recording = path.read_bytes(), read_recording([path])
    assert whole.count(payload) == 1
    place = next(k for k, message in enumerate(recording.messages) if message.copy.payload == payload)
    intact, n_found = recording.messages[place], 0
    for at in range(len(payload)):
        bad = payload[:at] + bytes([payload[at] ^ 1 << at % 8]) + payload[at + 1 :]
        recording.messages[place] = replace_payload(intact, bad)
        found = [recording]
        if at % 50 == 0:
            path.write_bytes(whole.replace(payload, bad))
            found.append(read_recording([path]))
        for one in found:
            assert places(one) == [(episode, step, what)], at
            n_found += 1
    assert n_found > len(payload) > 100
    divergence = verify(read_episodes(recording), FakeStepper().perform).divergence
    assert str(divergence).startswith(
        f"first divergence at episode {episode}, step {step}, field {what}: expected bytes"
    )


def replace_payload(message: Recorded, payload: bytes) -> Recorded:
    return Recorded(topic=message.topic, origin=message.origin, copy=replace(message.copy, payload=payload))


def places(recording: Recording) -> list[tuple[int, int, str]]:
    """Episode, step and field of everything that is damaged."""
    return [(one.index, each.step, each.field) for one in read_episodes(recording) for each in one.damage]


def damaged(path: Path, at: bytes, shift: int = 0) -> Recording:
    """The recording, after a bit has flipped where these bytes begin, or beyond."""
    data = bytearray(path.read_bytes())
    data[data.index(at) + shift] ^= 1
    path.write_bytes(data)
    return read_recording([path])


def test_a_message_whose_channel_is_not_known_is_missed_and_others_are_read(tmp_path: Path) -> None:
    actions, answers = traffic(MISSION)
    (path,) = write(tmp_path / "a.mcap", actions, answers)
    recording = damaged(path, actions[5].payload, -21)
    assert (recording.n_lost, recording.n_damaged_chunks) == (1, 1)
    assert len(recording.messages) == len(actions) + len(answers) - 1


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
        "1 messages are damaged: their bytes are not those that were recorded",
        "1 pieces of it had a bit that flipped before it was recovered",
        "agent/main/mission.json was damaged before it was recovered, and is agent/main/mission.json.damaged now",
    ):
        assert words in told
    before = {key: mark for key, mark in recording.marks.items() if key[2] == 5}
    again = tmp_path / "c.mcap"
    out.write_bytes(out.read_bytes()[:-100])
    recover(out, again)
    assert before.items() <= read_recording([again]).marks.items()


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
        n_damaged += len(recording.damaged_attachments) == 1 or recording.n_damaged_chunks == 1
    assert n_damaged == len(FACT.data) + 44
    recording = damaged(path, FACT.data, 9)
    assert recording.damaged_attachments == {"agent/main/mission.json"}
    assert "1 files are damaged: agent/main/mission.json" in "\n".join(lines(recording))
    with pytest.raises(RecordingError, match=r"agent/main/mission.json of the recording is damaged"):
        read_facts(recording)
