"""What is known about the contents of a recording: what is complete, lost, or damaged."""

import pytest

from legpush.errors import RecordingError
from legpush.messages import codec
from legpush.recording.digests import Mark
from legpush.recording.mcap_file.contents import Recorded, Recording
from legpush.recording.mcap_file.writer import Attachment
from tests.legpush.recording.recordings import ACTIONS, AGENT, copy

MESSAGE = Recorded(topic="sim/main/action", origin=AGENT, copy=copy(ACTIONS, 3, b"bytes"))
KEY = ("sim/main/action", AGENT.incarnation, 3)


def test_a_recording_is_complete_if_its_recorder_said_so_and_nothing_is_lost() -> None:
    said = {"complete": "yes", "n_recorded": "1"}
    assert Recording(messages=[MESSAGE], completeness=said).is_complete
    without = Recording(completeness=said)
    assert (without.is_complete, without.n_lost) == (False, 1)
    assert not Recording(messages=[MESSAGE]).is_complete


def test_a_message_is_damaged_if_its_bytes_are_not_those_of_its_digest() -> None:
    right, wrong = Mark(codec.checksum(b"bytes"), None), Mark(codec.checksum(b"other"), None)
    assert Recording(messages=[MESSAGE], marks={KEY: right}).damaged_messages() == []
    assert Recording(messages=[MESSAGE], marks={KEY: wrong}).damaged_messages() == [MESSAGE]
    assert Recording(messages=[MESSAGE]).damaged_messages() == []


def test_a_damaged_file_is_refused() -> None:
    file = Attachment("agent/main/report.json", "application/json", b"{}")
    recording = Recording(attachments={file.name: file})
    assert recording.attachment("report.json") == file
    assert recording.attachment("mission.json") is None
    recording.damaged_attachments.add(file.name)
    with pytest.raises(RecordingError, match=r"agent/main/report\.json of the recording is damaged"):
        recording.attachment("report.json")
