"""What is exported: the episodes of a recording, whole or refused."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from legpush.errors import RecordingError
from legpush.history.run_history import RunHistory
from legpush.history.timeline import Timeline
from legpush.recording.episodes import EpisodeRecord, read_episodes
from legpush.recording.facts import scenario_of
from legpush.recording.mcap_file.reader import Recording, read_recording


@dataclass(frozen=True, kw_only=True)
class Exported:
    """An episode of the recording."""

    index: int
    """As `legpush info` counts it."""
    sim: str
    timeline: Timeline


@dataclass(frozen=True, kw_only=True)
class Source:
    """A recording to export from."""

    paths: tuple[Path, ...]
    recording: Recording
    timelines: RunHistory
    episodes: list[Exported]
    """Those that are exported."""

    @property
    def name(self) -> str:
        """Of its files."""
        return ", ".join(path.name for path in self.paths)


def read_source(paths: Sequence[Path], index: int | None, *, partial: bool) -> Source:
    """The episodes of a recording, or the one of them with an index; `RecordingError` where one is not whole.

    With `partial` an episode that is not whole ends before its first gap.
    """
    recording = read_recording(paths)
    records = read_episodes(recording)
    where = ", ".join(map(str, paths))
    if not records:
        topics = sorted({message.topic for message in recording.messages})
        raise RecordingError(
            f"{where}: expected a recording with actions and observations of a simulator, got one with "
            f"{', '.join(topics) or 'no messages'}"
        )
    if index is not None:
        if index >= len(records):
            choices = ", ".join(str(record.index) for record in records)
            raise RecordingError(f"{where}: expected one of its episodes, {choices}, for --episode, got {index}")
        records = records[index : index + 1]
    timelines = _timelines(recording)
    episodes = []
    for record in records:
        timeline = timelines.episodes.get((record.sim, record.number))
        if not partial:
            _require_whole(record, timeline, where)
        if timeline is not None:
            episodes.append(Exported(index=record.index, sim=record.sim, timeline=timeline))
    if not episodes:
        raise RecordingError(f"{where}: expected an episode with a step that was carried out, got none")
    return Source(paths=tuple(paths), recording=recording, timelines=timelines, episodes=episodes)


def longest(episodes: Sequence[Exported]) -> Exported:
    """The one with the most ticks; the first of those."""
    return max(episodes, key=lambda each: float(each.timeline.tick[-1] - each.timeline.tick[0]))


def notes(source: Source) -> Iterator[str]:
    """What the user should know of the recording."""
    recording = source.recording
    if not recording.is_complete:
        missing = recording.completeness.get("n_missing", "0")
        what = f"{missing} messages are missing" if missing != "0" else "its recorder did not say that it is"
        yield f"the recording is not complete ({what}); what it has of the chosen episodes was exported"
    for each in source.episodes:
        first = each.timeline.steps[0]
        if first.number:
            yield f"episode {each.index} begins with step {first.number}: what was before was not recorded"


def _timelines(recording: Recording) -> RunHistory:
    """Of all messages that are as they were recorded."""
    timelines = RunHistory()
    timelines.scenario = scenario_of(recording)
    for message in recording.messages:
        if recording.is_as_recorded(message):
            timelines.take_message(message.topic, message.origin, message.copy)
    return timelines


def _require_whole(record: EpisodeRecord, timeline: Timeline | None, where: str) -> None:
    """`RecordingError` where a step is damaged, or is missing before others that are there."""
    hint = "; --partial takes the steps before, --episode another episode"
    if record.damage:
        damage = record.damage[0]
        raise RecordingError(
            f"{where}: expected {damage.expected} as {damage.field} of episode {record.index}, step {damage.step}, "
            f"got {damage.got}{hint}"
        )
    answered = [number for number, asked in record.steps.items() if any(one.outcome for one in asked)]
    if not answered:
        return
    done = timeline.steps[-1].number if timeline is not None else -1
    if max(answered) > done:
        missing = done + 1 if timeline is not None else 0
        raise RecordingError(
            f"{where}: expected all steps of episode {record.index}, 0 to {max(answered)}, got none that was carried "
            f"out as step {missing}{hint}"
        )
