"""The recorder as a child process: its command line and its last words."""

import os
import sys
from pathlib import Path

import tyro

from legpush.bus.endpoints import Endpoints
from legpush.options.recordings import RecordOptions
from legpush.processes.child import Command
from legpush.processes.crew import Crew
from legpush.processes.recorder_process import recorder_arguments, what_is_missing


def test_its_command_line_is_one_that_the_recorder_takes() -> None:
    at = Endpoints(listen=("tcp/127.0.0.1:1",), connect=("tcp/127.0.0.1:2", "tcp/127.0.0.1:3"))
    argv = recorder_arguments(Path("a.mcap"), "r1", at, {"parent": "b.mcap", "branch": "a = b"})
    assert argv[:5] == (sys.executable, "-P", "-m", "legpush.entry", "legpush.launch.record")
    assert tyro.cli(RecordOptions, args=argv[5:]) == RecordOptions(
        file=Path("a.mcap").absolute(),
        run="r1",
        listen=at.listen,
        connect=at.connect,
        about=("parent=b.mcap", "branch=a = b"),
    )


def test_what_is_missing_is_what_it_said_after_what_it_wrote(tmp_path: Path) -> None:
    words = "print('12:00:00 recorder/main INFO recording'); print('wrote a.mcap: 3 messages, NOT COMPLETE')\n"
    notes = "print('    sim main did not say farewell'); print('    2 messages before')"
    argv = (sys.executable, "-I", "-S", "-c", words + notes)
    with Crew() as crew:
        process = crew.start(Command(role="recorder", argv=argv, log=tmp_path / "log", environment=os.environ))
        assert crew.next_event(20.0) is process
    assert what_is_missing(process) == ["sim main did not say farewell", "2 messages before"]
