"""An episode and its journal: what the journal holds is not asked again, and another mission is refused."""

from contextlib import ExitStack
from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.errors import DivergedError, JournalError, LegpushError, MotionError, OtherVersionError
from legpush.history.entries import Acted, Numbered, Observed, Opened
from legpush.history.journal import Journal, read_entries
from legpush.history.steps import PlanRecord, StepRecord, read_episode
from legpush.lockstep.episode import Episode
from legpush.messages.stepping import Motion, Outcome, Walk
from legpush.numerics.computed_with import NUMERICS
from legpush.numerics.current import current
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS
from tests.legpush.examples import QUERY, RESET
from tests.legpush.fakes import (
    FakeStepper,
    agent,
    crc_after,
    fake_plan,
    mission,
    opened,
    planner,
    sim,
)

MISSION = mission()
CRC = crc_after(MISSION)
MOTIONS_HERE = str(MOTION_VERSION)


def run_episode(directory: Path, journal_path: Path, n_steps: int) -> Outcome:
    """Plan and carry out the first steps of the mission."""
    with agent(directory) as asking, Journal(journal_path, opened()) as journal:
        episode = Episode(journal, asking.sim, asking.planner)
        assert episode.plan(QUERY) == fake_plan(QUERY)
        return [episode.step(motion) for motion in MISSION[:n_steps]][-1]


def test_an_episode_is_answered_by_its_journal_as_far_as_that_goes(tmp_path: Path) -> None:
    path = tmp_path / "episode-0000.journal"
    stepper = FakeStepper()
    with sim(tmp_path, stepper), planner(tmp_path):
        run_episode(tmp_path, path, 5)
        assert run_episode(tmp_path, path, 9).state_crc == crc_after(MISSION[:9])
    assert stepper.performed == MISSION[:9]
    assert run_episode(tmp_path, path, 9).state_crc == crc_after(MISSION[:9])


def test_what_happened_can_be_read_back(tmp_path: Path) -> None:
    path = tmp_path / "episode-0000.journal"
    with sim(tmp_path), planner(tmp_path):
        run_episode(tmp_path, path, len(MISSION))
    first, *steps = read_episode(path)
    assert first == PlanRecord(QUERY, fake_plan(QUERY))
    assert [step.motion for step in steps if isinstance(step, StepRecord)] == MISSION
    assert isinstance(steps[-1], StepRecord)
    assert steps[-1].outcome.state_crc == CRC
    assert isinstance(next(read_entries(path)), Opened)


def test_an_action_is_in_the_journal_before_it_is_sent(tmp_path: Path) -> None:
    path = tmp_path / "episode-0000.journal"
    seen: list[bool] = []

    class Witness(FakeStepper):
        def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
            *_, last = read_entries(path)
            seen.append(last == Acted(motion=motion, with_trace=with_trace))
            return super().perform(motion, with_trace=with_trace)

    with sim(tmp_path, Witness()), planner(tmp_path):
        run_episode(tmp_path, path, 4)
    assert seen == [True] * 4


def test_a_mission_that_asks_something_else_than_its_journal_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "episode-0000.journal"
    with sim(tmp_path), planner(tmp_path):
        run_episode(tmp_path, path, 2)
    with agent(tmp_path) as asking, Journal(path, opened()) as journal:
        episode = Episode(journal, asking.sim, asking.planner)
        episode.plan(QUERY)
        episode.step(RESET)
        with pytest.raises(
            JournalError, match=r"expected acted Walk\(\) as entry \d, got acted Follow.* another mission"
        ):
            episode.step(Walk())


def test_a_refused_motion_is_refused_again_from_the_journal(tmp_path: Path) -> None:
    path = tmp_path / "episode-0000.journal"
    for serving in (True, False):
        with ExitStack() as stack:
            if serving:
                stack.enter_context(sim(tmp_path))
            asking = stack.enter_context(agent(tmp_path))
            journal = stack.enter_context(Journal(path, opened()))
            episode = Episode(journal, asking.sim, asking.planner)
            episode.step(RESET)
            with pytest.raises(MotionError, match="Step 1: Expected a follow before the first walk"):
                episode.step(Walk())
            assert episode.step(MISSION[1]).state_crc == crc_after(MISSION[:2])
            assert episode.live == serving
    assert [record.motion for record in read_episode(path) if isinstance(record, StepRecord)] == MISSION[:2]


def test_an_episode_that_was_led_through_again_has_its_new_number_in_the_journal(tmp_path: Path) -> None:
    path = tmp_path / "episode-0000.journal"
    with agent(tmp_path) as asking, Journal(path, opened()) as journal:
        episode = Episode(journal, asking.sim, asking.planner)
        for motion in MISSION[:4]:
            with sim(tmp_path):
                episode.step(motion)
    entries = list(read_entries(path))
    numbers = [entry.episode for entry in entries if isinstance(entry, Numbered)]
    assert len(numbers) == 4
    assert numbers == sorted(set(numbers))
    observed = [entry for entry in entries if isinstance(entry, Observed)]
    assert observed[-1].outcome.state_crc == crc_after(MISSION[:4])


@pytest.mark.parametrize(
    ("versions", "kind", "words"),
    [
        (
            {MOTIONS: MOTIONS_HERE},
            DivergedError,
            "^other numerics: recorded with numerics that were not noted, here .*; Expected state ",
        ),
        (
            {MOTIONS: MOTIONS_HERE, NUMERICS: "native/1"},
            DivergedError,
            "^other numerics: recorded with native/1, here .*; Expected state ",
        ),
        (
            {MOTIONS: MOTIONS_HERE, NUMERICS: current().name},
            DivergedError,
            "^Expected state .* after step 0 of the journal, got ",
        ),
        (
            {MOTIONS: "1", NUMERICS: current().name},
            OtherVersionError,
            "^other version: recorded with motion version 1, here .*; the mission in .* cannot go on here: ",
        ),
        ({}, OtherVersionError, "^other version: recorded before motions had a version, here "),
    ],
)
def test_a_mission_of_another_version_or_other_numerics_is_told_apart_from_one_that_diverged(
    tmp_path: Path, versions: dict[str, str], kind: type[LegpushError], words: str
) -> None:
    """The simulator is another one, so it is led through the journal."""

    class Rounding(FakeStepper):
        def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
            outcome = super().perform(motion, with_trace=with_trace)
            return replace(outcome, state_crc=outcome.state_crc ^ 1)

    path = tmp_path / "episode-0000.journal"
    begun = replace(opened(), versions=versions)
    with sim(tmp_path), agent(tmp_path) as asking, Journal(path, begun) as journal:
        episode = Episode(journal, asking.sim, asking.planner)
        for motion in MISSION[:3]:
            episode.step(motion)
    with sim(tmp_path, Rounding()), agent(tmp_path) as asking, Journal(path, opened()) as journal:
        episode = Episode(journal, asking.sim, asking.planner)
        for motion in MISSION[:3]:
            episode.step(motion)
        with pytest.raises(kind, match=words):
            episode.step(MISSION[3])
