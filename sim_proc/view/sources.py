"""Sources of the history that the page shows: a recording, or a live run."""

import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from secrets import token_hex
from time import monotonic
from typing import Final

from legpush.bus.bus import Bus
from legpush.bus.secure.host_folder import Credentials
from legpush.errors import ConfigError, EndpointError, RecordingError
from legpush.history.run_history import RunHistory
from legpush.messages.telemetry import Origin
from legpush.recording.facts import scenario_of
from legpush.recording.mcap_file.contents import Recorded, Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.runs.choose_run import ChosenRun, choose_run, find_run, through_routers
from legpush.runs.live_runs import find_live_runs
from legpush.scene.scenario import Scenario
from sim_proc.view.listener import Listener

LOOK_S: Final = 0.3
"""Time between two searches for the next run."""
KEEP_EPISODES: Final = 100
"""Most episodes of live runs to keep; the oldest are forgotten."""


class RecordedSource:
    """The undamaged messages of a recording; a context manager, like `LiveSource`."""

    is_live = False

    def __init__(self, files: Sequence[Path]) -> None:
        """Open a recording.

        Raises:
            RecordingError: It cannot be read.
        """
        recording = read_recording(files)
        self.title = f"Recording {', '.join(path.name for path in files)}"
        self.is_reading = True
        self._scenario = _scenario(recording)
        self._left: Iterator[Recorded] = filter(recording.is_as_recorded, recording.messages)

    def __enter__(self) -> "RecordedSource":
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def pump(self, history: RunHistory, budget_s: float) -> None:
        """Add messages, for at most `budget_s`."""
        history.scenario = self._scenario
        until = monotonic() + budget_s
        for message in self._left:
            history.take_message(message.topic, message.origin, message.copy)
            if monotonic() >= until:
                return
        self.is_reading = False

    def live(self) -> list[Origin] | None:
        """None: the processes of a recording are long gone."""
        return None


def _scenario(recording: Recording) -> Scenario | None:
    """The scenario attached to a recording; None if it has none that can be read."""
    try:
        return scenario_of(recording)
    except RecordingError:  # damaged; most episodes have their own
        return None


class LiveSource:
    """The live run, or the next one to begin. When a run is over, it goes on with the one after it."""

    is_live = True
    is_reading = False

    def __init__(
        self,
        run: str | None,
        connect: tuple[str, ...],
        credentials: Credentials | None = None,
        *,
        routers: tuple[str, ...] = (),
        stop: threading.Event | None = None,
    ) -> None:
        """Choose a run by its name, or by endpoints to connect to, with `credentials` over TLS; or behind `routers`.

        `stop` ends waiting for a router.

        Raises:
            ConfigError: Several runs are possible, or `run` is not a valid name.
        """
        self._run = run
        self._connect = connect or routers
        self._stop = stop
        self._credentials = credentials
        self._watched = through_routers(run, routers, credentials) if routers else choose_run(run, connect, credentials)
        self._open = ExitStack()
        self._looked_at = monotonic()

    def __enter__(self) -> "LiveSource":
        self._attach()
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    @property
    def title(self) -> str:
        """Name of the source, for people."""
        return f"Run {self._watched.run}"

    def pump(self, history: RunHistory, budget_s: float) -> None:
        """Add messages that have arrived, for at most `budget_s`, and go on with the next run if this one is over."""
        self._listener.pump(history, budget_s)
        history.keep_newest(KEEP_EPISODES)
        if monotonic() - self._looked_at >= LOOK_S and not self._connect:
            following = self._next_run()
            self._looked_at = monotonic()
            if following is not None:
                self._open.close()
                self._watched = following
                history.said.clear()
                history.scenario = None
                self._attach()

    def live(self) -> list[Origin]:
        """Processes of the run that are alive."""
        return self._listener.live()

    def _attach(self) -> None:
        """Listen to the chosen run."""
        bus = Bus(self._watched.run, "recorder", f"view-{token_hex(3)}", self._watched.endpoints, stop=self._stop)
        self._listener = self._open.enter_context(Listener(self._open.enter_context(bus)))

    def _next_run(self) -> ChosenRun | None:
        """Another run that has begun, if no process of this one is alive."""
        if self._watched.launched in find_live_runs() or any(peer.role != "launcher" for peer in self.live()):
            return None
        try:
            found = find_run(self._run, self._connect, self._credentials)
        except (ConfigError, EndpointError):  # several have begun, or one without TLS: this one stays on the page
            return None
        return found if found is not None and found.launched != self._watched.launched else None
