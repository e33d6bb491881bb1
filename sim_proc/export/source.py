"""Reads the episodes of a recording to export, and refuses those that are not whole."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from legpush.errors import RecordingError
from legpush.history.run_history import RunHistory
from legpush.history.timeline import Timeline
from legpush.recording.episodes import EpisodeRecord, read_episodes
from legpush.recording.facts import scenario_of
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import read_recording


@dataclass(frozen=True, kw_only=True)
class Exported:
    """An episode to export."""

    index: int
    """Index of the episode, as in `legpush info`."""
    sim: str
    """Name of the simulator."""
    timeline: Timeline


@dataclass(frozen=True, kw_only=True)
class Source:
    """A recording to export from."""

    paths: tuple[Path, ...]
    recording: Recording
    history: RunHistory
    episodes: list[Exported]
    """The episodes to export."""

    @property
    def name(self) -> str:
        """Names of its files."""
        return ", ".join(path.name for path in self.paths)


def read_source(paths: Sequence[Path], index: int | None, *, partial: bool) -> Source:
    """Read the episodes of a recording, or only the one with an index.

    With `partial` an episode that is not whole ends before its first gap.

    Raises:
        RecordingError: The recording cannot be read, has no such episode, or an episode is not whole.
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
    history = _history(recording)
    episodes = []
    for record in records:
        timeline = history.episodes.get((record.sim, record.number))
        if not partial:
            _require_whole(record, timeline, where)
        if timeline is not None:
            episodes.append(Exported(index=record.index, sim=record.sim, timeline=timeline))
    if not episodes:
        raise RecordingError(f"{where}: expected an episode with a step that was carried out, got none")
    return Source(paths=tuple(paths), recording=recording, history=history, episodes=episodes)


def longest(episodes: Sequence[Exported]) -> Exported:
    """The episode with the most ticks, or the first of several."""
    return max(episodes, key=lambda each: float(each.timeline.tick[-1] - each.timeline.tick[0]))


def notes(source: Source) -> Iterator[str]:
    """Remarks on the recording that the user should read."""
    recording = source.recording
    if not recording.is_complete:
        missing = recording.completeness.get("n_missing", "0")
        what = f"{missing} messages are missing" if missing != "0" else "its recorder did not confirm that it is"
        yield f"the recording is not complete ({what}); the recorded part of the chosen episodes was exported"
    for each in source.episodes:
        first = each.timeline.steps[0]
        if first.number:
            yield f"episode {each.index} begins with step {first.number}: earlier steps were not recorded"


def _history(recording: Recording) -> RunHistory:
    """The history that all undamaged messages tell."""
    history = RunHistory()
    history.scenario = scenario_of(recording)
    for message in recording.messages:
        if recording.is_as_recorded(message):
            history.take_message(message.topic, message.origin, message.copy)
    return history


def _require_whole(record: EpisodeRecord, timeline: Timeline | None, where: str) -> None:
    """Check that an episode has no damaged step, and no missing step before a later one.

    Raises:
        RecordingError: It has one.
    """
    hint = "; --partial exports the steps before it, --episode another episode"
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
            f"{where}: expected all steps of episode {record.index}, 0 to {max(answered)}, got them without "
            f"step {missing}{hint}"
        )
