"""Where the page's timelines come from: a recording, or a run that goes on."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from secrets import token_hex
from time import monotonic
from typing import Final

from legpush.bus.bus import Bus
from legpush.errors import ConfigError, RecordingError
from legpush.history.run_history import RunHistory
from legpush.messages.telemetry import Origin
from legpush.recording.facts import scenario_of
from legpush.recording.mcap_file.reader import Recorded, Recording, read_recording
from legpush.runs.choose_run import ChosenRun, choose_run, find_run
from legpush.runs.live_runs import find_live_runs
from legpush.scene.scenario import Scenario
from sim_proc.view.listener import Listener

LOOK_S: Final = 0.3
"""Launchers are looked for this often."""
KEEP_EPISODES: Final = 100
"""Of a live run, however long it lasts."""


class RecordedSource:
    """All messages of a recording that are as they were recorded; a context manager as the others are."""

    is_live = False

    def __init__(self, files: Sequence[Path]) -> None:
        """`RecordingError` where it cannot be read."""
        recording = read_recording(files)
        self.title = f"Recording {', '.join(path.name for path in files)}"
        self.is_reading = True
        self._scenario = _scenario(recording)
        self._left: Iterator[Recorded] = filter(recording.is_as_recorded, recording.messages)

    def __enter__(self) -> "RecordedSource":
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def pump(self, timelines: RunHistory, budget_s: float) -> None:
        """Add messages for so long at most."""
        timelines.scenario = self._scenario
        until = monotonic() + budget_s
        for message in self._left:
            timelines.take_message(message.topic, message.origin, message.copy)
            if monotonic() >= until:
                return
        self.is_reading = False

    def live(self) -> list[Origin] | None:
        """Nobody is there any more."""
        return None


def _scenario(recording: Recording) -> Scenario | None:
    """The one among its files; None where there is none that can be read."""
    try:
        return scenario_of(recording)
    except RecordingError:  # it is damaged; most episodes bring their own
        return None


class LiveSource:
    """The run that goes on, or the next one that begins; when it is over, the one after it."""

    is_live = True
    is_reading = False

    def __init__(self, run: str | None, connect: tuple[str, ...]) -> None:
        """What the command line says; `ConfigError` where several runs are meant."""
        self._run = run
        self._connect = connect
        self._watched = choose_run(run, connect)
        self._open = ExitStack()
        self._looked_at = monotonic()

    def __enter__(self) -> "LiveSource":
        self._attach()
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    @property
    def title(self) -> str:
        """For people."""
        return f"Run {self._watched.run}"

    def pump(self, timelines: RunHistory, budget_s: float) -> None:
        """Add what has come, for so long at most; look for the next run where this one is over."""
        self._listener.pump(timelines, budget_s)
        timelines.keep_newest(KEEP_EPISODES)
        if monotonic() - self._looked_at >= LOOK_S and not self._connect:
            following = self._next_run()
            self._looked_at = monotonic()
            if following is not None:
                self._open.close()
                self._watched = following
                timelines.said.clear()
                timelines.scenario = None
                self._attach()

    def live(self) -> list[Origin]:
        """Who is there."""
        return self._listener.live()

    def _attach(self) -> None:
        bus = Bus(self._watched.run, "recorder", f"view-{token_hex(3)}", self._watched.endpoints)
        self._listener = self._open.enter_context(Listener(self._open.enter_context(bus)))

    def _next_run(self) -> ChosenRun | None:
        """Another one that has begun, where nobody of this one is there."""
        if self._watched.launched in find_live_runs() or any(peer.role != "launcher" for peer in self.live()):
            return None
        try:
            found = find_run(self._run, self._connect)
        except ConfigError:  # several have begun: this one stays on the page
            return None
        return found if found is not None and found.launched != self._watched.launched else None
