"""The recorder of a mission: what the user is told of it, and what the report says."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from legpush.bus.endpoints import Endpoints
from legpush.files import next_file
from legpush.launch import mission_recorder
from legpush.launch.mission_recorder import MissionRecorder
from legpush.processes.crew import Crew
from tests.legpush.launch.notebook import Notebook

COMPLETE = "print('wrote m.mcap: 9 messages, complete')"
LACKING = "print('wrote m.mcap: 8 messages, NOT COMPLETE'); print('    1 message is missing'); raise SystemExit(1)"
FAILED = "print('error: m.mcap: the recording cannot go on'); raise SystemExit(2)"


@pytest.fixture
def recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], tuple[list[str], dict[str, object]]]:
    """Runs code in the place of a recorder; returns the notices and what the report says of the recording."""

    def run(code: str) -> tuple[list[str], dict[str, object]]:
        argv = (sys.executable, "-I", "-S", "-c", code)
        monkeypatch.setattr(mission_recorder, "recorder_arguments", lambda *arguments: argv)
        (tmp_path / "report.json").write_text('{"success": true}')
        display = Notebook()
        recorder = MissionRecorder(tmp_path / "m.mcap", "r1", Endpoints(), display)
        with Crew() as crew:
            recorder.start(crew, tmp_path / "recorder.log", {}, {})
            assert crew.next_event(20.0) is not None
        recorder.complete_report(tmp_path)
        report = json.loads((tmp_path / "report.json").read_text())
        assert report["success"]
        assert report["recording"].pop("file") == str(tmp_path / "m.mcap")
        return display.notices, report["recording"]

    return run


def test_a_complete_recording_is_noted_in_the_report_alone(
    recorded: Callable[[str], tuple[list[str], dict[str, object]]],
) -> None:
    assert recorded(COMPLETE) == ([], {"complete": True, "notes": []})


def test_what_a_recording_lacks_is_told_and_noted(
    recorded: Callable[[str], tuple[list[str], dict[str, object]]],
) -> None:
    notices, noted = recorded(LACKING)
    assert notices == ["the recording is not complete:\n    1 message is missing"]
    assert noted == {"complete": False, "notes": ["1 message is missing"]}


def test_a_recorder_that_fails_is_told_with_its_error_and_how_to_save_what_there_is(
    recorded: Callable[[str], tuple[list[str], dict[str, object]]], tmp_path: Path
) -> None:
    notices, noted = recorded(FAILED)
    words = (
        f"the recorder exited with 2: m.mcap: the recording cannot go on; its log is {tmp_path}/recorder.log; the "
        f"mission goes on without it; `legpush recover {tmp_path}/m.mcap` saves what was recorded"
    )
    assert notices == [words]
    assert noted == {"complete": False, "notes": [words]}


def test_a_recorder_that_ends_during_the_mission_is_told_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    argv = (sys.executable, "-I", "-S", "-c", "import os; os.kill(os.getpid(), 9)")
    monkeypatch.setattr(mission_recorder, "recorder_arguments", lambda *arguments: argv)
    display = Notebook()
    recorder = MissionRecorder(tmp_path / "m.mcap", "r1", Endpoints(), display)
    with Crew() as crew:
        recorder.start(crew, tmp_path / "recorder.log", {}, {})
        process = crew.next_event(20.0)
        assert process is not None
        recorder.note_end(process)  # type: ignore[arg-type]
    recorder.complete_report(tmp_path)
    (notice,) = display.notices
    assert notice.startswith("the recorder was killed by SIGKILL; its log is ")
    assert not (tmp_path / "report.json").exists()


def test_what_goes_on_is_recorded_to_the_next_file_that_is_free(tmp_path: Path) -> None:
    file = tmp_path / "m.mcap"
    file.touch()
    assert next_file(file).name == "m-2.mcap"
    (tmp_path / "m-2.mcap").touch()
    assert next_file(file).name == "m-3.mcap"
    assert next_file(tmp_path / "m-2.mcap").name == "m-3.mcap"
    (tmp_path / "seed-7.mcap").touch()
    assert next_file(tmp_path / "seed-7.mcap").name == "seed-7-2.mcap"
