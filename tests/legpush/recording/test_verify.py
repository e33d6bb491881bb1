"""Verification: the recorded steps again, in the order of steps, up to the first difference."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.errors import RecordingError
from legpush.messages import codec
from legpush.messages.stepping import Observation, Outcome, PushReport, Walk
from legpush.messages.telemetry import Copy
from legpush.recording.episodes import difference, read_episodes, same
from legpush.recording.mcap_file.reader import Recorded, read_recording
from legpush.recording.verify import Verified, verify
from tests.legpush.examples import WORLD
from tests.legpush.fakes import FakeStepper, mission
from tests.legpush.recording.recordings import a_recording, traffic, write

PUSHED = PushReport(leg="FL", touched=True, peak_force_n=1.0)


def verified(path: Path) -> Verified:
    return verify(read_episodes(read_recording([path])), FakeStepper().perform)


def test_what_was_recorded_is_identical(tmp_path: Path) -> None:
    found = verified(a_recording(tmp_path / "a.mcap"))
    assert found.divergence is None
    assert found.n_steps == len(mission())


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


def replace_copy(message: Recorded, **changes: object) -> Recorded:
    return Recorded(topic=message.topic, origin=message.origin, copy=replace(message.copy, **changes))


def test_a_motion_that_was_refused_has_to_be_refused_again(tmp_path: Path) -> None:
    motions = mission()
    path = a_recording(tmp_path / "a.mcap", [motions[0], Walk(), *motions[1:]])
    assert verified(path).divergence is None
    episodes = read_episodes(read_recording([path]))
    assert len(episodes[0].steps[1]) == 2


@pytest.mark.parametrize("bit", [0, 3, 7])
@pytest.mark.parametrize("place", [0.05, 0.3, 0.6, 0.97])
def test_a_bit_that_flips_anywhere_in_an_action_is_found_at_its_step(tmp_path: Path, bit: int, place: float) -> None:
    path = a_recording(tmp_path / "a.mcap")
    step = 12
    actions, _ = traffic(mission())
    payload = actions[step].payload
    data = bytearray(path.read_bytes())
    assert data.count(payload) == 1
    data[data.index(payload) + int(place * len(payload))] ^= 1 << bit
    path.write_bytes(data)
    found = verified(path)
    assert found.n_steps == step
    assert str(found.divergence).startswith(f"first divergence at episode 0, step {step}, field action: expected bytes")


def test_an_answer_that_the_simulator_does_not_give_is_found_with_field_and_values(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    answer = codec.decode(answers[7].payload, Observation)
    outcome = replace(answer.outcome, world=replace(answer.outcome.world, n_footsteps=99))
    answers[7] = replace(answers[7], payload=codec.encode(replace(answer, outcome=outcome)))
    write(tmp_path / "a.mcap", actions, answers)
    divergence = verified(tmp_path / "a.mcap").divergence
    assert divergence is not None
    assert (divergence.step, divergence.field, divergence.expected) == (7, "world.n_footsteps", "99")


def test_zeros_of_either_sign_are_not_the_same() -> None:
    positive, negative = (
        Outcome(world=replace(WORLD, push=replace(PUSHED, peak_force_n=zero)), state_crc=1) for zero in (0.0, -0.0)
    )
    assert positive == negative
    assert same(positive, positive)
    assert not same(positive, negative)
    assert difference(positive, negative) == ("world.push.peak_force_n", "0.0", "-0.0")


def test_a_step_that_is_not_in_the_recording_is_named(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    without: list[Copy] = [action for action in actions if action.sequence != 5]
    write(tmp_path / "a.mcap", without, answers)
    with pytest.raises(RecordingError, match="expected steps 0 to 23, but step 5 is not in the recording"):
        verified(tmp_path / "a.mcap")
