"""The checker finds what a fault could have done: steps that are missing, doubled or altered, and foreign answers."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.history.entries import Acted, Entry, Observed, Planned, Queried
from legpush.history.journal import Journal
from legpush.messages import codec
from legpush.messages.stepping import Motion, Observation, Walk
from legpush.messages.telemetry import Copy
from legpush.soak.check import differences, recorded_wrongs, steps_of
from legpush.soak.mission import JOURNAL
from tests.legpush.examples import PLAN, QUERY
from tests.legpush.fakes import FakeStepper, mission, opened
from tests.legpush.recording.recordings import traffic, write

MOTIONS = mission(5)


def entries(motions: list[Motion]) -> list[Entry]:
    """What an agent writes into a journal."""
    stepper, written = FakeStepper(), list[Entry]([Queried(query=QUERY), Planned(plan=PLAN)])
    for motion in motions:
        written.append(Acted(motion=motion, with_trace=False))
        written.append(Observed(outcome=stepper.perform(motion, with_trace=False)))
    return written


def run_of(folder: Path, written: list[Entry]) -> Path:
    """A folder of a mission with this journal."""
    folder.mkdir()
    with Journal(folder / JOURNAL, opened()) as journal:
        for entry in written:
            journal.append(entry)
    states = [entry.outcome.state_crc for entry in written if isinstance(entry, Observed)]
    (folder / "report.json").write_text(json.dumps({"state_crc": f"{states[-1]:08x}"}))
    return folder


def altered(entry: Entry) -> Entry:
    assert isinstance(entry, Observed)
    return replace(entry, outcome=replace(entry.outcome, state_crc=entry.outcome.state_crc ^ 1))


WRONGS: dict[str, tuple[Callable[[list[Entry]], list[Entry]], str]] = {
    "nothing": (lambda all_: all_, ""),
    "a step is missing": (lambda all_: all_[:6] + all_[8:], "steps instead of"),
    "a step is doubled": (lambda all_: all_[:8] + all_[6:], "steps instead of"),
    "an answer is altered": (lambda all_: [*all_[:7], altered(all_[7]), *all_[8:]], "step 2 of the journal is another"),
    "the last answer is altered": (lambda all_: [*all_[:-1], altered(all_[-1])], "state_crc"),
    "an answer came twice": (lambda all_: [*all_[:8], all_[7], *all_[8:]], "does not follow"),
    "a question has no answer": (lambda all_: all_[:7] + all_[8:], "does not follow"),
}


@pytest.mark.parametrize("wrong", WRONGS)
def test_a_journal_is_compared_with_that_of_the_undisturbed_mission(tmp_path: Path, wrong: str) -> None:
    change, words = WRONGS[wrong]
    expected = run_of(tmp_path / "expected", entries(MOTIONS))
    found = differences(run_of(tmp_path / "run", change(entries(MOTIONS))), expected)
    assert bool(found) == bool(words)
    assert words in "; ".join(found)


def test_a_mission_without_a_report_or_journal_is_no_mission(tmp_path: Path) -> None:
    expected = run_of(tmp_path / "expected", entries(MOTIONS))
    run = run_of(tmp_path / "run", entries(MOTIONS))
    (run / "report.json").unlink()
    assert "state_crc None in the report" in differences(run, expected)[0]
    (run / JOURNAL).unlink()
    assert "Expected to read the journal" in differences(run, expected)[0]


Traffic = tuple[list[Copy], list[Copy]]


def doubled(sent: Traffic) -> Traffic:
    """An answer whose state is another one, the second time."""
    actions, answers = sent
    message = codec.decode(answers[3].payload, Observation)
    changed = replace(
        message,
        header=replace(message.header, sequence=message.header.sequence + 1000),
        outcome=replace(message.outcome, state_crc=7),
    )
    copy = replace(answers[3], sequence=answers[3].sequence + 1000, payload=codec.encode(changed))
    return actions, [*answers[:4], copy, *answers[4:]]


RECORDED: dict[str, tuple[Callable[[Traffic], Traffic], str]] = {
    "nothing": (lambda sent: sent, ""),
    "an answer again": (lambda sent: (sent[0], [*sent[1][:4], sent[1][3], *sent[1][4:]]), ""),
    "an action is missing": (
        lambda sent: ([*sent[0][:3], *sent[0][4:]], sent[1]),
        "step 3 was answered, but not asked",
    ),
    "a step done twice": (doubled, "step 3 was carried out twice"),
    "a step left out": (lambda sent: (sent[0], [*sent[1][:3], *sent[1][4:]]), "step 4 of episode"),
}


@pytest.mark.parametrize("wrong", RECORDED)
def test_recordings_are_compared_with_the_journal(tmp_path: Path, wrong: str) -> None:
    change, words = RECORDED[wrong]
    actions, answers = change(traffic(MOTIONS))
    write(tmp_path / "mission.mcap", actions, answers)
    found = recorded_wrongs([tmp_path / "mission.mcap"], steps_of(entries(MOTIONS)))
    assert bool(found) == bool(words), found
    assert words in "; ".join(found)


def test_the_last_action_of_a_killed_agent_may_be_missing_if_the_recording_says_so(tmp_path: Path) -> None:
    actions, answers = traffic(MOTIONS)
    paths = write(tmp_path / "mission.mcap", actions[:-1], answers, says_farewell=False)
    assert recorded_wrongs(paths, steps_of(entries(MOTIONS))) == []


def test_a_recorded_motion_that_is_not_that_of_the_journal_is_found(tmp_path: Path) -> None:
    actions, answers = traffic(MOTIONS)
    write(tmp_path / "mission.mcap", actions, answers)
    steps = steps_of(entries(MOTIONS))
    steps[2] = (Walk(), steps[2][1]) if steps[2][0] != Walk() else (MOTIONS[4], steps[2][1])
    assert any("step 2 was asked as another" in wrong for wrong in recorded_wrongs([tmp_path / "mission.mcap"], steps))
