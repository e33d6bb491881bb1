"""The steps and plans of an episode, read back from its journal."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from legpush.errors import JournalError
from legpush.history.entries import Acted, Awaited, Entry, Numbered, Observed, Planned, Queried, Refused
from legpush.history.journal import Journal
from legpush.history.steps import PlanRecord, StepRecord, read_episode, words_of
from legpush.messages.planning import Plan
from legpush.messages.stepping import Outcome, Walk
from tests.legpush.examples import PLAN, QUERY, RESET, WORLD
from tests.legpush.fakes import opened

BETTER = Plan(status="exact", reason="", n_iterations=99)
DONE = Outcome(world=WORLD, state_crc=7)


def journal_of(folder: Path, entries: Sequence[Entry]) -> Path:
    with Journal(folder / "j", opened()) as journal:
        for entry in entries:
            journal.append(entry)
    return journal.path


def test_steps_and_plans_come_in_order_without_what_was_refused_or_not_answered(tmp_path: Path) -> None:
    path = journal_of(
        tmp_path,
        [
            Numbered(episode=5),
            Acted(motion=RESET, with_trace=True),
            Observed(outcome=DONE),
            Queried(query=QUERY),
            Planned(plan=PLAN),
            Acted(motion=Walk(), with_trace=True),
            Refused(reason="no path"),
            Awaited(revision=1),
            Planned(plan=BETTER),
            Acted(motion=Walk(), with_trace=False),
        ],
    )
    assert list(read_episode(path)) == [StepRecord(RESET, DONE), PlanRecord(QUERY, PLAN), PlanRecord(QUERY, BETTER)]


@pytest.mark.parametrize(
    "entries",
    [
        [Observed(outcome=DONE)],
        [Planned(plan=PLAN)],
        [Queried(query=QUERY), Observed(outcome=DONE)],
        [Acted(motion=Walk(), with_trace=True), Planned(plan=PLAN)],
        [Queried(query=QUERY), Planned(plan=PLAN), Acted(motion=Walk(), with_trace=True), Planned(plan=PLAN)],
    ],
)
def test_an_answer_to_something_else_is_an_error(tmp_path: Path, entries: list[Entry]) -> None:
    with pytest.raises(JournalError, match=r"j: (observed|planned) answers nothing"):
        list(read_episode(journal_of(tmp_path, entries)))


def test_an_entry_is_told_in_a_few_words() -> None:
    assert words_of(Awaited(revision=2)) == "awaited"
    assert words_of(Acted(motion=Walk(), with_trace=True)) == "acted Walk()"
    assert len(words_of(Acted(motion=RESET, with_trace=True))) == 300
