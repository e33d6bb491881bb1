"""The recorder: each message once, and those that are wanted."""

from pathlib import Path

from msgspec.structs import replace

from legpush.messages.telemetry import Origin
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import RecordingFile, Split
from legpush.recording.recorder import Recorder, Wanted
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import ABOUT, AGENT, SIM, batch, copy, traffic


def test_a_batch_counts_once_and_a_filter_asks_for_less(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    file = RecordingFile(tmp_path / "a.mcap", ABOUT)
    recorder = Recorder(file, Wanted(topics=("sim/*/action",)))
    for _ in range(2):
        recorder.write_batch(batch(AGENT, 0, actions, final=True))
        recorder.write_batch(batch(SIM, 0, answers, final=True))
    completeness = recorder.ledger.completeness()
    file.finish({})
    assert completeness.complete
    assert completeness.n_recorded == len(actions)
    assert {message.topic for message in read_recording(file.parts).messages} == {"sim/main/action"}


def test_what_a_planner_and_a_witness_of_it_hand_over_is_recorded_once(tmp_path: Path) -> None:
    planner = Origin(role="planner", name="main", incarnation="planner-1")
    file = RecordingFile(tmp_path / "a.mcap", ABOUT, Split(None, None))
    recorder = Recorder(file, Wanted())
    said = [copy("legpush/v5/test/plan/main/result", sequence, b"a") for sequence in range(5)]
    heard = batch(planner, 0, said[:3])
    recorder.write_batch(replace(heard, header=replace(heard.header, role="agent", incarnation="agent-1")))
    recorder.write_batch(batch(planner, 0, said, final=True))
    found = recorder.ledger.completeness()
    assert (found.complete, found.n_recorded, found.n_missing) == (True, 5, 0)
    file.abandon()
