"""A recording that is published again."""

from pathlib import Path

import pytest

from legpush.errors import RecordingError
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.publish import from_start
from tests.legpush.recording.recordings import a_recording


def test_what_is_published_again_begins_where_it_is_asked_to(tmp_path: Path) -> None:
    recording = read_recording([a_recording(tmp_path / "a.mcap")])
    times = [message.copy.time_ns for message in from_start(recording, 0.1)]
    assert times == sorted(times)
    assert times[0] == min(message.copy.time_ns for message in recording.messages) + 100_000_000
    with pytest.raises(RecordingError, match=r"Expected a --start of at most 0.2 s, where the recording ends"):
        from_start(recording, 3.0)
