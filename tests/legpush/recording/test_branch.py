"""A recording as the past of a branch: what was answered, and nothing else."""

from pathlib import Path

import pytest

from legpush.errors import ConfigError, OtherVersionError, RecordingError
from legpush.messages.stepping import Push
from legpush.numerics.computed_with import ComputedWith
from legpush.numerics.motion_version import MOTION_VERSION
from legpush.recording.branch import BranchPoint, RecordedPast, parse_point
from legpush.recording.mcap_file.reader import read_recording
from tests.legpush.fakes import FakeStepper, mission
from tests.legpush.recording.recordings import a_recording, beyond_the_bounds, traffic

OTHER = Push(w1=0.5, w2=0.123, leg="FL", depth_m=0.1)


def test_the_past_of_a_branch_answers_the_recorded_motions_only(tmp_path: Path) -> None:
    past = RecordedPast(read_recording([a_recording(tmp_path / "a.mcap")]), BranchPoint(0, 8))
    past.computed_with = ComputedWith(str(MOTION_VERSION))
    fake = FakeStepper()
    for step, motion in enumerate(mission()[:8]):
        assert past.act(step, motion, with_trace=True) == fake.perform(motion, with_trace=True)
    with pytest.raises(RecordingError, match=r"step 7 of the recording: expected push with w2 0.15 as recorded"):
        past.act(7, OTHER, with_trace=True)


def test_another_motion_than_another_version_recorded_is_told_as_that(tmp_path: Path) -> None:
    past = RecordedPast(read_recording([a_recording(tmp_path / "a.mcap")]), BranchPoint(0, 8))
    past.act(0, mission()[0], with_trace=True)
    with pytest.raises(OtherVersionError, match=r"^other version: recorded before motions had a version, here \d+; "):
        past.act(7, OTHER, with_trace=True)


@pytest.mark.parametrize(
    ("point", "words"),
    [
        (BranchPoint(1, 3), "Expected an episode from 0 to 0 for --at, got 1"),
        (BranchPoint(0, 25), "Expected a step from 1 to 24 of episode 0 for --at, got 25"),
        (BranchPoint(0, 0), "Expected a step from 1 to 24 of episode 0 for --at, got 0"),
    ],
)
def test_a_branch_point_that_does_not_exist_is_refused(tmp_path: Path, point: BranchPoint, words: str) -> None:
    with pytest.raises(RecordingError, match=words):
        RecordedPast(read_recording([a_recording(tmp_path / "a.mcap")]), point)


def test_a_branch_from_behind_a_damaged_step_is_refused(tmp_path: Path) -> None:
    path = a_recording(tmp_path / "a.mcap")
    data = bytearray(path.read_bytes())
    data[data.index(traffic(mission())[0][4].payload) + 40] ^= 1
    path.write_bytes(data)
    RecordedPast(read_recording([path]), BranchPoint(0, 4))
    with pytest.raises(RecordingError, match="episode 0, step 4: its action is damaged"):
        RecordedPast(read_recording([path]), BranchPoint(0, 4 + 1))


def test_a_branch_from_a_number_beyond_its_bounds_is_refused_with_its_field(tmp_path: Path) -> None:
    recording = read_recording([beyond_the_bounds(tmp_path / "a.mcap")])
    with pytest.raises(RecordingError, match=r"step 0: its action .* <= 1000\.0 - at `\$\..*\.box\.mass_kg`"):
        RecordedPast(recording, BranchPoint(0, 4))


@pytest.mark.parametrize("text", ["", "3", "0:", "0:-1", "a:1", "0:1:2"])
def test_a_branch_point_is_two_numbers(text: str) -> None:
    with pytest.raises(ConfigError, match="Expected EPISODE:STEP for --at, such as 0:12, got "):
        parse_point(text)
