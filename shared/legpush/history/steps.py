"""Reads the steps and plans of an episode back from its journal."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from legpush.errors import JournalError
from legpush.history.entries import Acted, Awaited, Entry, Numbered, Observed, Opened, Planned, Queried, Refused
from legpush.history.journal import read_entries
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome


class StepRecord(NamedTuple):
    """An action that was carried out."""

    motion: Motion
    outcome: Outcome


class PlanRecord(NamedTuple):
    """A query that was answered."""

    query: PlanQuery
    plan: Plan


def read_episode(path: Path) -> Iterator[StepRecord | PlanRecord]:
    """What happened in the episode, in order, for reports and pictures; refused and unanswered actions left out."""
    question: Acted | Queried | Awaited | None = None
    query: PlanQuery | None = None
    for entry in read_entries(path):
        match entry:
            case Acted() | Queried() | Awaited():
                question = entry
                query = entry.query if isinstance(entry, Queried) else query
            case Observed(outcome=outcome) if isinstance(question, Acted):
                yield StepRecord(question.motion, outcome)
            case Planned(plan=plan) if query is not None and not isinstance(question, Acted):
                yield PlanRecord(query, plan)
            case Opened() | Numbered() | Refused():
                pass
            case _:
                raise JournalError(f"{path}: {words_of(entry)} answers nothing")


def words_of(entry: Entry) -> str:
    """What an entry is, in a few words."""
    name = type(entry).__name__.lower()
    return f"{name} {entry.motion!r}"[:300] if isinstance(entry, Acted) else name
