"""An episode that continues a recorded one: its past comes from the recording, its state from a simulator led there."""

from collections.abc import Callable
from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.errors import DivergedError, OtherVersionError
from legpush.history.journal import Journal
from legpush.lockstep.episode import Episode
from legpush.messages.stepping import Motion, Outcome, Push
from legpush.numerics.computed_with import ComputedWith
from legpush.numerics.current import current
from legpush.numerics.motion_version import MOTION_VERSION
from legpush.recording.branch import BranchPoint, RecordedPast
from legpush.recording.mcap_file.reader import read_recording
from tests.legpush.fakes import FakeStepper, agent, crc_after, mission, opened, sim
from tests.legpush.recording.recordings import a_recording

BRANCH_AT = 8
OTHER = [Push(w1=0.9, w2=0.1, leg="FR", depth_m=0.05 + 0.01 * index) for index in range(4)]


class Traceless(RecordedPast):
    """Lacks the trace of some steps, as where a simulator was killed."""

    lacks: tuple[int, ...] = (5,)
    changes: Callable[[Outcome], Outcome] = staticmethod(lambda outcome: outcome)

    def act(self, step: int, motion: Motion, *, with_trace: bool) -> Outcome:
        outcome = super().act(step, motion, with_trace=with_trace)
        return self.changes(replace(outcome, trace=None)) if step in self.lacks else outcome


def past_of(tmp_path: Path, kind: type[RecordedPast] = RecordedPast) -> RecordedPast:
    path = tmp_path / "a.mcap"
    return kind(read_recording([path if path.exists() else a_recording(path)]), BranchPoint(0, BRANCH_AT))


def run(tmp_path: Path, motions: list[Motion], past: RecordedPast) -> list[Outcome]:
    with agent(tmp_path) as asking, Journal(tmp_path / "j", opened()) as journal:
        episode = Episode(journal, asking.sim, asking.planner, past)
        return [episode.step(motion, with_trace=True) for motion in motions]


def test_the_simulator_is_led_to_the_branch_point_and_goes_on_from_there(tmp_path: Path) -> None:
    stepper = FakeStepper()
    motions = [*mission()[:BRANCH_AT], *OTHER]
    with sim(tmp_path, stepper):
        outcomes = run(tmp_path, motions, past_of(tmp_path))
    assert outcomes[-1].state_crc == crc_after(motions)
    assert stepper.performed == motions
    assert all(outcome.trace is not None for outcome in outcomes)


@pytest.mark.parametrize("n_before", [3, BRANCH_AT, BRANCH_AT + 2])
def test_a_branch_that_was_interrupted_goes_on_where_it_ended(tmp_path: Path, n_before: int) -> None:
    motions = [*mission()[:BRANCH_AT], *OTHER]
    with sim(tmp_path):
        before = run(tmp_path, motions[:n_before], past_of(tmp_path))
        outcomes = run(tmp_path, motions, past_of(tmp_path))
    assert outcomes[:n_before] == before
    assert outcomes[-1].state_crc == crc_after(motions)


def test_a_trace_that_the_recording_lacks_is_made_again(tmp_path: Path) -> None:
    stepper = FakeStepper()
    motions = [*mission()[:BRANCH_AT], *OTHER]
    with sim(tmp_path, stepper):
        outcomes = run(tmp_path, motions, past_of(tmp_path, Traceless))
    assert outcomes[5].trace is not None
    assert stepper.performed == motions
    assert outcomes[-1].state_crc == crc_after(motions)


OTHER_STATE = (
    "^other numerics: recorded with native/1, here .*; Expected state 00000007 after step 5, as recorded, got "
)


def test_a_simulator_with_the_recorded_numerics_that_comes_to_another_state_has_diverged(tmp_path: Path) -> None:
    past = past_of(tmp_path, Traceless)
    past.computed_with = ComputedWith(str(MOTION_VERSION), current().name)
    past.changes = lambda outcome: replace(outcome, state_crc=7)  # type: ignore[attr-defined]
    with sim(tmp_path), pytest.raises(DivergedError, match=r"^Expected state 00000007 after step 5, as recorded, got "):
        run(tmp_path, mission()[:BRANCH_AT], past)


def test_a_simulator_that_comes_to_another_state_than_was_recorded_is_refused(tmp_path: Path) -> None:
    past = past_of(tmp_path, Traceless)
    past.computed_with = ComputedWith(str(MOTION_VERSION), "native/1")
    past.changes = lambda outcome: replace(outcome, state_crc=7)  # type: ignore[attr-defined]
    with sim(tmp_path), pytest.raises(DivergedError, match=OTHER_STATE):
        run(tmp_path, mission()[:BRANCH_AT], past)


def test_a_recording_of_another_version_that_comes_to_another_state_is_told_as_that(tmp_path: Path) -> None:
    past = past_of(tmp_path, Traceless)
    past.changes = lambda outcome: replace(outcome, state_crc=7)  # type: ignore[attr-defined]
    words = r"^other version: recorded before motions had a version, here \d+; it cannot be verified or "
    with sim(tmp_path), pytest.raises(OtherVersionError, match=words):
        run(tmp_path, mission()[:BRANCH_AT], past)
