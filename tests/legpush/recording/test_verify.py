"""Verification: the recorded steps again, in the order of steps, up to the first difference."""

from pathlib import Path

import msgspec
import pytest
from msgspec.structs import replace

from legpush.errors import RecordingError
from legpush.messages import codec
from legpush.messages.stepping import Motion, Observation, Outcome, Walk
from legpush.messages.telemetry import Copy, Fact
from legpush.numerics.motion_version import MOTION_VERSION
from legpush.recording.episodes import read_episodes
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.verify import Verified, check, verify
from tests.legpush.fakes import FakeStepper, mission
from tests.legpush.recording.recordings import a_recording, traffic, write


def verified(path: Path) -> Verified:
    return verify(read_episodes(read_recording([path])), FakeStepper().perform)


def test_what_was_recorded_is_identical(tmp_path: Path) -> None:
    found = verified(a_recording(tmp_path / "a.mcap"))
    assert found.divergence is None
    assert found.n_steps == len(mission())


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


def test_a_step_that_is_not_in_the_recording_is_named(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    without: list[Copy] = [action for action in actions if action.sequence != 5]
    write(tmp_path / "a.mcap", without, answers)
    with pytest.raises(RecordingError, match="expected steps 0 to 23, but step 5 is not in the recording"):
        verified(tmp_path / "a.mcap")


class Rounding(FakeStepper):
    """A simulator that rounds differently from step 5 on."""

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        outcome = super().perform(motion, with_trace=with_trace)
        return replace(outcome, state_crc=outcome.state_crc ^ 1) if len(self.performed) > 5 else outcome


def recorded_here(file: Path, numerics: str | None, motions: str | None = str(MOTION_VERSION)) -> Path:
    noted = {"name": numerics, "profile": "x86-64-v3", "motions": motions}
    data = msgspec.json.encode({key: text for key, text in noted.items() if text is not None})
    facts = (Fact(name="numerics.json", media_type="application/json", data=data),)
    (path,) = write(file, *traffic(mission()), facts=facts)
    return path


@pytest.mark.parametrize(
    ("recorded", "words"),
    [
        ("x86-64-v3/1", "first divergence at episode 0, step 5, field state_crc: expected "),
        ("native/2", "other numerics: recorded with native/2, here x86-64-v3/1; first difference at episode 0, step 5"),
        (None, "other numerics: recorded with numerics that were not noted, here x86-64-v3/1; first difference at "),
    ],
)
def test_other_bits_of_other_numerics_are_no_divergence(tmp_path: Path, recorded: str | None, words: str) -> None:
    path = recorded_here(tmp_path / "a.mcap", recorded)
    checked = check(read_recording([path]), Rounding().perform, lambda: "x86-64-v3/1")
    assert checked.words(1.0).startswith(words)
    assert not checked.is_sound


@pytest.mark.parametrize(
    ("motions", "words"),
    [
        ("1", f"other version: recorded with motion version 1, here {MOTION_VERSION}; it cannot be verified"),
        (None, f"other version: recorded before motions had a version, here {MOTION_VERSION}; it cannot be verified"),
    ],
)
@pytest.mark.parametrize("numerics", ["x86-64-v3/1", "native/2", None])
def test_other_bits_of_another_version_are_told_as_that_and_nothing_else(
    tmp_path: Path, numerics: str | None, motions: str | None, words: str
) -> None:
    path = recorded_here(tmp_path / "a.mcap", numerics, motions)
    checked = check(read_recording([path]), Rounding().perform, lambda: pytest.fail("asked without need"))
    assert checked.other_version
    assert not checked.is_sound
    assert checked.words(1.0).startswith(words)
    assert len(checked.words(1.0).splitlines()) == 1
    assert "divergence" not in checked.words(1.0)


@pytest.mark.parametrize("motions", [str(MOTION_VERSION), "1", None])
def test_equal_bits_are_identical_whatever_the_numerics_and_the_version(tmp_path: Path, motions: str | None) -> None:
    path = recorded_here(tmp_path / "a.mcap", "native/2", motions)
    checked = check(read_recording([path]), FakeStepper().perform, lambda: pytest.fail("asked without need"))
    assert checked.words(1.0).startswith("identical: 24 steps")


@pytest.mark.parametrize("motions", [str(MOTION_VERSION), "1"])
def test_damage_is_not_put_down_to_other_numerics_or_another_version(tmp_path: Path, motions: str) -> None:
    path = recorded_here(tmp_path / "a.mcap", "native/2", motions)
    data = bytearray(path.read_bytes())
    data[data.index(traffic(mission())[0][3].payload) + 40] ^= 1
    path.write_bytes(data)
    checked = check(read_recording([path]), FakeStepper().perform, lambda: "x86-64-v3/1")
    assert checked.words(1.0).startswith("first divergence at episode 0, step 3, field action")
