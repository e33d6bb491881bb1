"""What is exported of a recording that is not whole, and what is refused."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from legpush.errors import RecordingError
from legpush.messages.telemetry import Copy, Fact
from legpush.scenarios.file import dump_scenario
from sim_proc.export.source import longest, notes, read_source
from tests.legpush.recording.recordings import ACTIONS, write
from tests.sim.conftest import standing_at_the_box
from tests.sim.export.conftest import Messages, room


def without(copies: Sequence[Copy], *places: int) -> list[Copy]:
    return [copy for place, copy in enumerate(copies) if place not in places]


def test_episodes_are_counted_as_they_began_and_the_longest_has_most_ticks(recorded: Path) -> None:
    source = read_source([recorded], None, partial=False)
    assert [episode.index for episode in source.episodes] == [0, 1]
    assert longest(source.episodes).index == 0
    (second,) = read_source([recorded], 1, partial=False).episodes
    assert second.index == 1
    assert second.timeline.n_rows == source.episodes[1].timeline.n_rows < source.episodes[0].timeline.n_rows
    assert list(notes(source)) == []


def test_an_episode_that_is_not_there_is_refused_with_those_that_are(recorded: Path) -> None:
    with pytest.raises(RecordingError, match=r"a\.mcap: expected one of its episodes, 0, 1, for --episode, got 2"):
        read_source([recorded], 2, partial=False)


def test_a_missing_step_is_named_and_partial_takes_those_before(said: Messages, tmp_path: Path) -> None:
    actions, answers = said
    write(tmp_path / "gap.mcap", actions, without(answers, 1), n_per_batch=50)
    with pytest.raises(RecordingError, match=r"of episode 0, 0 to 3, got them without step 1;"):
        read_source([tmp_path / "gap.mcap"], None, partial=False)
    assert read_source([tmp_path / "gap.mcap"], 1, partial=False).episodes[0].index == 1
    source = read_source([tmp_path / "gap.mcap"], 0, partial=True)
    assert [step.number for step in source.episodes[0].timeline.steps] == [0]
    assert "1 messages are missing" in next(notes(source))


def test_a_flipped_bit_is_found_where_it_is(recorded: Path, said: Messages, tmp_path: Path) -> None:
    data = bytearray(recorded.read_bytes())
    payload = said[1][1].payload
    at = bytes(data).index(payload)
    data[at + len(payload) // 2] ^= 1
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(data)
    with pytest.raises(RecordingError, match=r"as observation of episode 0, step 1, got .*--partial exports"):
        read_source([damaged], 0, partial=False)
    source = read_source([damaged], 0, partial=True)
    assert [step.number for step in source.episodes[0].timeline.steps] == [0]


def test_a_recording_that_began_late_is_exported_from_there_on_and_said_so(said: Messages, tmp_path: Path) -> None:
    scenario = room(standing_at_the_box())
    facts = (Fact(name="scenario.toml", media_type="application/toml", data=dump_scenario(scenario).encode()),)
    late = tmp_path / "late.mcap"
    actions, answers = said
    write(late, without(actions[:4], 0), without(answers[:4], 0), n_per_batch=50, facts=facts)
    source = read_source([late], None, partial=False)
    (episode,) = source.episodes
    assert [step.number for step in episode.timeline.steps] == [1, 2, 3]
    assert episode.timeline.scenario == scenario
    assert episode.timeline.tick[0] == 1
    assert np.isfinite(episode.timeline.zmp_m).all()
    assert any("episode 0 begins with step 1" in note for note in notes(source))


def test_a_recording_without_a_simulator_is_refused_with_what_it_has(said: Messages, tmp_path: Path) -> None:
    file = tmp_path / "plans.mcap"
    write(file, [copy for copy in said[0] if copy.key != ACTIONS], [], n_per_batch=50)
    with pytest.raises(RecordingError, match=r"plans\.mcap: expected a recording with actions and observations .* got"):
        read_source([file], None, partial=False)
