"""Reads the episodes of a recording, by step instead of by wall clock; a message that was sent again counts once."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypeVar, cast

import msgspec

from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.stepping import Action, Answer, Motion, Observation, Outcome, Refusal
from legpush.recording.mcap_file.contents import Recorded, Recording

T = TypeVar("T", Action, Answer)


@dataclass(kw_only=True)
class Asked:
    """A motion that was requested as a step."""

    motion: Motion
    with_trace: bool
    answer: bytes | None = None
    """The recorded bytes of the observation; None if the motion was refused or not answered."""
    refusal: str | None = None
    """The reason for which the motion was refused, if it was."""

    @property
    def is_told(self) -> bool:
        """Whether the motion was answered or refused."""
        return self.answer is not None or self.refusal is not None

    @property
    def outcome(self) -> Outcome | None:
        """The decoded answer; decoded each time, since traces take many times the memory of their bytes."""
        return codec.decode(self.answer, Observation).outcome if self.answer is not None else None


@dataclass(kw_only=True)
class Damage:
    """A message with other bytes than were recorded, or bytes that are no message."""

    step: int
    field: str
    """`action` or `observation`."""
    expected: str
    got: str


@dataclass(kw_only=True)
class EpisodeRecord:
    """The motions that one simulator was asked for, from a reset to the next."""

    index: int
    """Index in the recording, from 0."""
    sim: str
    number: int
    """Number of the episode on the bus."""
    steps: dict[int, list[Asked]] = field(default_factory=dict)
    """Motions by step. Of several motions for one step, in their order, all but the last were refused."""
    damage: list[Damage] = field(default_factory=list)

    def carried_out(self) -> list[Asked]:
        """Return the steps that were answered, in order, up to the first that was not."""
        done: list[Asked] = []
        for number in range(len(self.steps)):
            asked = self.steps.get(number, [])
            if not asked or asked[-1].answer is None:
                break
            done.append(asked[-1])
        return done

    @property
    def label(self) -> str:
        """Name of the episode in texts for people."""
        return f"episode {self.index}"


def read_episodes(recording: Recording) -> list[EpisodeRecord]:
    """Return all episodes of all simulators, in the order in which they began."""
    return _Reader(recording).read()


class _Reader:
    """Sorts actions and answers into episodes."""

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self._episodes: dict[tuple[str, int], EpisodeRecord] = {}
        self._before: dict[tuple[str, str], tuple[int, int]] = {}
        """Episode and step of the last undamaged message, by topic and incarnation."""

    def read(self) -> list[EpisodeRecord]:
        """Read actions first, so that every answer finds its action."""
        parts = [(message, message.topic.split("/")) for message in self._recording.messages]
        for message, topic in parts:
            if topic[0] == "sim" and topic[-1] == "action":
                self._take_action(message, topic[1])
        for message, topic in parts:
            if topic[0] == "sim" and topic[-1] == "observation":
                self._take_answer(message, topic[1])
        begun = [episode for episode in self._episodes.values() if episode.damage or _was_answered(episode)]
        for index, episode in enumerate(begun):
            episode.index = index
        return begun

    def _episode(self, sim: str, number: int) -> EpisodeRecord:
        return self._episodes.setdefault(
            (sim, number), EpisodeRecord(index=len(self._episodes), sim=sim, number=number)
        )

    def _take_action(self, message: Recorded, sim: str) -> None:
        action = self._decoded(message, sim, Action, "action")
        if action is None:
            return
        asked = self._episode(sim, action.episode).steps.setdefault(action.step, [])
        if all((one.motion, one.with_trace) != (action.motion, action.with_trace) for one in asked):
            asked.append(Asked(motion=action.motion, with_trace=action.with_trace))

    def _take_answer(self, message: Recorded, sim: str) -> None:
        answer = self._decoded(message, sim, cast(type[Answer], Observation | Refusal), "observation")
        episode = self._episodes.get((sim, answer.episode)) if answer is not None else None
        if answer is None or episode is None:
            return
        asked = episode.steps.get(answer.step, [])
        if isinstance(answer, Refusal):
            if answer.cause == "invalid":
                for one in asked:
                    if one.refusal in (None, answer.reason):
                        one.refusal = answer.reason
                        break
        elif asked:
            last = asked[-1]
            before = last.outcome
            if before is None:
                last.answer = message.copy.payload
            elif not same(before, answer.outcome):
                path, expected, got = difference(before, answer.outcome)
                damage = Damage(step=answer.step, field=path, expected=expected, got=f"{got}, answered again")
                episode.damage.append(damage)

    def _decoded(self, message: Recorded, sim: str, kind: type[T], what: str) -> T | None:
        """Return the message, or None if it is damaged; the damage is noted at its step.

        If no digest has the step, it is the one after the last undamaged message.
        """
        place: tuple[str, str] = (message.topic, message.origin.incarnation)
        mark = self._recording.mark(message)
        got = codec.checksum(message.copy.payload)
        decoded: T | None = None
        why = f"bytes with CRC {got:08x}"
        if mark is None or mark.crc == got:
            try:
                decoded = codec.decode(message.copy.payload, kind)
            except MessageError as error:
                why = f"no message: {error}"
        if decoded is not None:
            self._before[place] = (decoded.episode, decoded.step)
            return decoded
        before = self._before.get(place)
        number, step = (before[0], before[1] + 1) if before is not None else (self._first_number(sim), 0)
        if mark is not None and mark.place is not None:
            number, step = mark.place
        expected = f"bytes with CRC {mark.crc:08x}" if mark is not None else "a message"
        self._episode(sim, number).damage.append(Damage(step=step, field=what, expected=expected, got=why))
        return None

    def _first_number(self, sim: str) -> int:
        return next((number for name, number in self._episodes if name == sim), 0)


def _was_answered(episode: EpisodeRecord) -> bool:
    """Return whether a simulator carried out or refused any step, and did not just ask for the steps before it."""
    return any(one.is_told for asked in episode.steps.values() for one in asked)


def same(one: msgspec.Struct, other: msgspec.Struct) -> bool:
    """Return whether two records are the same, bit for bit."""
    return msgspec.msgpack.encode(one) == msgspec.msgpack.encode(other)


def difference(expected: msgspec.Struct, got: msgspec.Struct) -> tuple[str, str, str]:
    """Return the path of the first field in which two records differ, and both values."""
    for path, one, other in _differences("", msgspec.to_builtins(expected), msgspec.to_builtins(got)):
        return path.lstrip("."), _short(one), _short(other)
    return "(none)", "", ""


def _differences(path: str, one: object, other: object) -> Iterable[tuple[str, object, object]]:
    if isinstance(one, dict) and isinstance(other, dict) and one.keys() == other.keys():
        for name in one:
            yield from _differences(f"{path}.{name}", one[name], other[name])
    elif isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)) and len(one) == len(other):
        for index, (first, second) in enumerate(zip(one, other, strict=True)):
            yield from _differences(f"{path}[{index}]", first, second)
    elif repr(one) != repr(other):
        yield path, one, other


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
