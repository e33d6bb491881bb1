"""The episodes of a recording: steps that count once, and a bit that flips, found where it is."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.messages import codec
from legpush.messages.stepping import Action, Observation, Outcome, PushReport
from legpush.messages.telemetry import Copy
from legpush.recording.episodes import difference, read_episodes, same
from legpush.recording.mcap_file.contents import Recorded, Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.verify import verify
from tests.legpush.examples import WORLD
from tests.legpush.fakes import FakeStepper, mission
from tests.legpush.recording.recordings import (
    ACTIONS,
    AGENT,
    ANSWERS,
    EPISODE,
    SIM,
    a_recording,
    copy,
    header,
    traffic,
    write,
)

PUSHED = PushReport(leg="FL", touched=True, peak_force_n=1.0)


def replace_copy(message: Recorded, **changes: object) -> Recorded:
    return Recorded(topic=message.topic, origin=message.origin, copy=replace(message.copy, **changes))


def test_what_the_wire_repeated_counts_once_whatever_the_order(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    path = tmp_path / "a.mcap"
    write(path, actions, answers)
    recording = read_recording([path])
    repeated = [
        replace_copy(message, sequence=message.copy.sequence + 1000) for message in recording.messages if message.topic
    ]
    recording.messages = [*reversed(repeated), *recording.messages]
    (episode,) = read_episodes(recording)
    assert [len(asked) for asked in episode.steps.values()] == [1] * len(mission())
    assert verify([episode], FakeStepper().perform).divergence is None


def test_answers_are_kept_as_they_were_recorded_since_traces_take_many_times_their_bytes(tmp_path: Path) -> None:
    recording = read_recording([a_recording(tmp_path / "a.mcap")])
    payloads = {id(message.copy.payload) for message in recording.messages}
    answers = [asked.answer for episode in read_episodes(recording) for asked in episode.carried_out()]
    assert len(answers) == len(mission())
    assert all(id(answer) in payloads for answer in answers)


def test_zeros_of_either_sign_are_not_the_same() -> None:
    positive, negative = (
        Outcome(world=replace(WORLD, push=replace(PUSHED, peak_force_n=zero)), state_crc=1) for zero in (0.0, -0.0)
    )
    assert positive == negative
    assert same(positive, positive)
    assert not same(positive, negative)
    assert difference(positive, negative) == ("world.push.peak_force_n", "0.0", "-0.0")


MISSION = mission(4)
RESENT = 3
"""Step of the second episode whose action is sent once more."""


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
