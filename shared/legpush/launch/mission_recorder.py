"""Starts the recorder of a mission. It ends with the mission, and its failure does not end the mission."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from legpush.bus.endpoints import Endpoints
from legpush.launch.display import Display
from legpush.launch.last_words import error_of
from legpush.processes.child import Command, Process, describe_exit
from legpush.processes.crew import Crew
from legpush.processes.recorder_process import INCOMPLETE, recorder_arguments, what_is_missing
from legpush.runs.folder import REPORT_FILE
from legpush.runs.report import read_report, write_report


class MissionRecorder:
    """Starts the recorder process, tells the user when it fails, and adds its result to the report."""

    def __init__(self, file: Path, run: str, endpoints: Endpoints, display: Display) -> None:
        self._file = file.absolute()
        self._run = run
        self._endpoints = endpoints
        self._display = display
        self._process: Process | None = None
        self._failure: str | None = None

    def start(self, crew: Crew, log: Path, environment: Mapping[str, str], about: Mapping[str, str]) -> None:
        """Start the recorder; `about` becomes metadata of the recording."""
        argv = recorder_arguments(self._file, self._run, self._endpoints, about)
        self._process = crew.start(Command(role="recorder", argv=argv, log=log, environment=environment))

    def note_end(self, process: Process) -> None:
        """Tell the user at once that the recorder ended although the mission goes on."""
        why = f": {error_of(process)}" if (process.exit_code or 0) > 0 else ""
        self._failure = (
            f"the recorder {describe_exit(process.exit_code or 0)}{why}; its log is {process.command.log}; the mission "
            f"goes on without it; `legpush recover {self._file}` saves what was recorded"
        )
        self._display.notice(self._failure)

    def complete_report(self, folder: Path) -> None:
        """After the mission, tell the user what is missing, and add `recording` to the report."""
        if self._process is None:
            return
        code = self._process.exit_code
        if self._failure is None and code not in (0, INCOMPLETE):
            self.note_end(self._process)
        notes = what_is_missing(self._process)
        if self._failure is None and code == INCOMPLETE:
            self._display.notice("\n    ".join(("the recording is not complete:", *notes)))
        if (folder / REPORT_FILE).exists():
            recording: dict[str, Any] = {"file": str(self._file), "complete": code == 0 and self._failure is None}
            recording["notes"] = [self._failure] if self._failure is not None else notes
            write_report({**read_report(folder), "recording": recording}, folder)
