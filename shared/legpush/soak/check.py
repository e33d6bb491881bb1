"""Reads what a disturbed mission left behind: every step exactly once, every answer to its question, the same state."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from legpush.errors import LegpushError, MessageError
from legpush.history.entries import Acted, Awaited, Entry, Numbered, Observed, Opened, Planned, Queried
from legpush.history.journal import read_entries
from legpush.messages import codec
from legpush.messages.stepping import Action, Answer, Motion, Observation, Refusal
from legpush.recording.mcap_file.reader import read_recording
from legpush.soak.mission import JOURNAL

Place = tuple[str, int, int]
"""Incarnation of a simulator, episode and step."""


def question_of(entries: Sequence[Entry]) -> list[str]:
    """Return what is wrong with the order of the entries of a journal."""
    wrong: list[str] = []
    question: Entry | None = None
    for index, entry in enumerate(entries):
        match entry:
            case Opened():
                follows = index == 0
            case Numbered():
                follows = index > 0
            case Acted() | Queried() | Awaited():
                follows, question = question is None, entry
            case Planned():
                follows, question = isinstance(question, Queried | Awaited), None
            case _:
                follows, question = isinstance(question, Acted), None
        if not follows:
            wrong.append(f"entry {index} of the journal, {type(entry).__name__}, does not follow from those before it")
    return wrong


def steps_of(entries: Sequence[Entry]) -> list[tuple[Motion, int]]:
    """Return the steps of a journal that were carried out: each motion and the state that it led to."""
    steps: list[tuple[Motion, int]] = []
    motion: Motion | None = None
    for entry in entries:
        if isinstance(entry, Acted):
            motion = entry.motion
        elif isinstance(entry, Observed) and motion is not None:
            steps.append((motion, entry.outcome.state_crc))
    return steps


def report_of(out: Path) -> dict[str, Any]:
    """Return the report of a mission; empty if there is none."""
    try:
        report: dict[str, Any] = json.loads((out / "report.json").read_bytes())
    except OSError:
        return {}
    return report


def differences(out: Path, expected: Path) -> list[str]:
    """Return how the journal and the report of a mission differ from those of the undisturbed one."""
    try:
        entries = list(read_entries(out / JOURNAL))
        undisturbed = list(read_entries(expected / JOURNAL))
    except LegpushError as error:
        return [str(error)]
    wrong = question_of(entries)
    steps, wanted = steps_of(entries), steps_of(undisturbed)
    if len(steps) != len(wanted):
        wrong.append(f"{len(steps)} steps instead of {len(wanted)}")
    for number, (got, want) in enumerate(zip(steps, wanted, strict=False)):
        if got != want:
            wrong.append(
                f"step {number} of the journal is another one: {type(got[0]).__name__} to {got[1]:08x}, "
                f"instead of {type(want[0]).__name__} to {want[1]:08x}"
            )
            break
    crc, wanted_crc = report_of(out).get("state_crc"), report_of(expected).get("state_crc")
    if crc != wanted_crc:
        wrong.append(f"state_crc {crc} in the report instead of {wanted_crc}")
    return wrong


def recorded_wrongs(files: Sequence[Path], steps: Sequence[tuple[Motion, int]]) -> list[str]:
    """Return what is wrong with the messages in the recordings of a mission, whose journal has these steps.

    Each simulator carries out each step once, in order from its reset on; each observation answers an action that was
    asked; and every observation of a step has the state that the journal has. The last actions of a killed agent may be
    missing, if the recording says so.
    """
    wrong: list[str] = []
    asked: set[tuple[str, int, int]] = set()
    answered: dict[Place, int] = {}
    last: dict[str, tuple[int, int]] = {}
    recordings = [read_recording([file]) for file in files]
    messages = [message for recording in recordings for message in recording.messages]
    missing = " ".join(text for recording in recordings for text in recording.completeness.values())
    for message in messages:
        if message.topic.endswith("/action"):
            action = codec.decode(message.copy.payload, Action)
            asked.add((action.header.incarnation, action.episode, action.step))
            if action.step < len(steps) and action.motion != steps[action.step][0]:
                wrong.append(f"step {action.step} was asked as another {type(action.motion).__name__}")
    for message in messages:
        if not message.topic.endswith("/observation"):
            continue
        try:
            answer: Answer = codec.decode(message.copy.payload, Observation)
        except MessageError:
            codec.decode(message.copy.payload, Refusal)
            continue
        if not isinstance(answer, Observation):
            continue
        place = (answer.header.incarnation, answer.episode, answer.step)
        crc = answer.outcome.state_crc
        to = answer.agent_incarnation
        if (to, answer.episode, answer.step) not in asked and f"({to}) did not say farewell" not in missing:
            wrong.append(f"step {answer.step} was answered, but not asked by {answer.agent_incarnation}")
        if answered.setdefault(place, crc) != crc:
            wrong.append(f"step {answer.step} was carried out twice, to {answered[place]:08x} and {crc:08x}")
        if answer.step < len(steps) and crc != steps[answer.step][1]:
            wrong.append(f"step {answer.step} led to {crc:08x}, but the journal has {steps[answer.step][1]:08x}")
        before = last.get(answer.header.incarnation)
        now = (answer.episode, answer.step)
        if before is not None and now not in (before, (before[0], before[1] + 1)) and answer.step != 0:
            wrong.append(f"step {now[1]} of episode {now[0]} came after step {before[1]} of episode {before[0]}")
        last[answer.header.incarnation] = now
    return list(dict.fromkeys(wrong))
