"""A recording that is published again."""

from pathlib import Path
from threading import Event

import pytest

from legpush.errors import RecordingError
from legpush.messages.telemetry import Fact
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.publish import from_start, publish
from tests.legpush.bus.memory_session import KeptBatches, MemoryNetwork
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import AGENT, SIM, a_recording, damaged, traffic, write


def test_what_is_published_again_begins_where_it_is_asked_to(tmp_path: Path) -> None:
    recording = read_recording([a_recording(tmp_path / "a.mcap")])
    times = [message.copy.time_ns for message in from_start(recording, 0.1)]
    assert times == sorted(times)
    assert times[0] == min(message.copy.time_ns for message in recording.messages) + 100_000_000
    with pytest.raises(RecordingError, match=r"Expected a --start of at most 0.2 s, where the recording ends"):
        from_start(recording, 3.0)


def test_each_process_is_published_as_it_was_with_its_files_but_those_that_are_damaged(tmp_path: Path) -> None:
    facts = tuple(Fact(name=name, media_type="text/plain", data=f"of {name}".encode()) for name in ("a.txt", "b.txt"))
    (path,) = write(tmp_path / "a.mcap", *traffic(mission()), facts=facts)
    recording = damaged(path, b"of b.txt")
    network = MemoryNetwork()
    with network.bus("recorder") as recorder:
        handed_over = KeptBatches(recorder, "launcher", "replay")
        with network.bus("launcher", "replay") as bus:
            recorder.announce()
            n = publish(bus, recording, rate=100.0, start_s=0.0, stop=Event())
    assert n == len(recording.messages)
    for origin in (AGENT, SIM):
        expected = [message.copy for message in recording.messages if message.origin == origin]
        got = [copy for batch in handed_over.batches if batch.origin == origin for copy in batch.copies]
        assert [(copy.key, copy.sequence, copy.payload) for copy in got] == [
            (copy.key, copy.sequence, copy.payload) for copy in expected
        ]
    files = {(batch.origin.role, fact.name) for batch in handed_over.batches for fact in batch.facts}
    assert files == {("agent", "a.txt"), ("sim", "a.txt"), ("sim", "b.txt")}


def test_published_a_second_time_the_processes_are_other_incarnations(tmp_path: Path) -> None:
    recording = read_recording([a_recording(tmp_path / "a.mcap")])
    network = MemoryNetwork()
    with network.bus("recorder") as recorder:
        handed_over = KeptBatches(recorder, "launcher", "replay")
        with network.bus("launcher", "replay") as bus:
            recorder.announce()
            for turn in range(2):
                publish(bus, recording, rate=100.0, start_s=0.0, stop=Event(), turn=turn)
    incarnations = {batch.origin.incarnation for batch in handed_over.batches if batch.copies}
    assert incarnations == {"agent-1", "sim-1", "agent-1-1", "sim-1-1"}


def test_it_ends_when_it_is_asked_to(tmp_path: Path) -> None:
    recording, stop = read_recording([a_recording(tmp_path / "a.mcap")]), Event()
    stop.set()
    with MemoryNetwork().bus("launcher", "replay") as bus:
        assert publish(bus, recording, rate=0.001, start_s=0.0, stop=stop) < len(recording.messages)
