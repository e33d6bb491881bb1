"""The page: a viser server on this machine, and the loop that shows what the player points at."""

import socket
import threading
from collections.abc import Callable, Collection
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from math import cos, sin
from time import monotonic, time_ns
from typing import Final, Protocol

import viser

from legpush.errors import ConfigError
from legpush.geometry import rpy_from_quaternion
from legpush.messages.tap import Origin
from legpush.timeline import TRUNK, Timeline
from legpush.timelines import Timelines
from sim_proc.view.panel import FOLLOW_ROBOT, Command, Panel, speed_of
from sim_proc.view.player import Player
from sim_proc.view.plots import Plots
from sim_proc.view.scene import LAYERS, Scene
from sim_proc.view.statuses import conditions

PERIOD_S: Final = 1 / 25
"""Of the scene."""
TIME_PERIOD_S: Final = 0.12
"""Of the slider, and what is written beside it."""
SLOW_PERIOD_S: Final = 0.5
"""Of plots and statuses."""
PUMP_S: Final = 0.02


@dataclass(frozen=True)
class Camera:
    """Where it stands, and what it looks at, in the frame of the robot."""

    position_m: tuple[float, float, float]
    look_at_m: tuple[float, float, float]


CAMERAS: Final = {
    "Behind": Camera((-2.2, -1.4, 1.4), (0.5, 0.0, 0.1)),
    "Side": Camera((0.4, -2.6, 0.9), (0.4, 0.0, 0.2)),
    "Top": Camera((-0.05, 0.0, 6.0), (0.0, 0.0, 0.0)),
}


class Source(Protocol):
    """Where timelines come from."""

    is_live: bool

    @property
    def title(self) -> str:
        """For people."""

    def pump(self, timelines: Timelines, budget_s: float) -> None:
        """Add what has come, for so long at most."""

    def live(self) -> Collection[Origin] | None:
        """Who is there; None where that is long ago."""


class Page:
    """A context manager: the server stops on exit."""

    def __init__(self, source: Source, host: str, port: int) -> None:
        """`ConfigError` where nobody can listen there; port 0 is any that is free."""
        port = _free_port(host, port)
        self._source = source
        with redirect_stdout(StringIO()):  # viser announces itself
            self._server = viser.ViserServer(host=host, port=port, label="legpush", verbose=False)
        self.url = f"http://{host}:{self._server.get_port()}"
        self._server.gui.configure_theme(
            control_layout="fixed", control_width="medium", show_logo=False, show_share_button=False
        )
        self._server.initial_camera.position = CAMERAS["Behind"].position_m
        self._server.initial_camera.look_at = CAMERAS["Behind"].look_at_m
        self._server.initial_camera.fov = 0.75
        self._scene = Scene(self._server)
        self._panel = Panel(self._server, live=source.is_live)
        panel = self._server.gui.add_panel()
        with panel.add_tab("Plots"):
            self._plots = Plots(self._server)
        panel.dock_left()
        self._timelines = Timelines()
        self._timeline: Timeline | None = None
        self._player = Player(follows=source.is_live)
        self._follows_newest = True
        self._follows_robot = True

    def __enter__(self) -> "Page":
        return self

    def __exit__(self, *_: object) -> None:
        with redirect_stdout(StringIO()):
            self._server.stop()

    def run(self, stop: threading.Event) -> None:
        """Until `stop`."""
        shown_at = slow_at = time_shown_at = monotonic()
        while not stop.is_set():
            self._source.pump(self._timelines, PUMP_S)
            for command in self._panel.commands():
                self._obey(command)
            self._choose()
            now = monotonic()
            if self._timeline is not None:
                self._player.advance(now - shown_at, self._timeline)
                row = self._player.row(self._timeline)
                if self._server.get_clients():
                    self._scene.show(self._timelines, self._timeline, row, follow=self._follows_robot)
                if now - time_shown_at >= TIME_PERIOD_S:
                    time_shown_at = now
                    self._panel.show_time(self._timeline, row, self._player)
            shown_at = now
            if now - slow_at >= SLOW_PERIOD_S:
                slow_at = now
                self._show_slow()
            stop.wait(max(0.0, PERIOD_S - (monotonic() - now)))

    def _show_slow(self) -> None:
        at_ns = time_ns()
        if self._timeline is not None:
            row = self._player.row(self._timeline)
            self._plots.show(self._timeline, row)
            if not self._player.follows:
                at_ns = self._timeline.time_ns_at(row)
        live = self._source.live() if self._player.follows or self._timeline is None else None
        if self._timeline is None:
            self._panel.show_waiting(self._source.is_live)
        self._panel.show_processes(self._source.title, conditions(self._timelines.said, at_ns, live))

    def _choose(self) -> None:
        """Which episode is looked at: the newest of a live run until somebody chooses otherwise."""
        episodes = self._timelines.episodes
        if not episodes:
            return
        newest = list(episodes.values())[-1 if self._source.is_live else 0]
        if self._timeline is None or (self._follows_newest and self._source.is_live and newest is not self._timeline):
            self._begin(newest)
        labels = [f"{index}: simulator {sim}" for index, (sim, _) in enumerate(episodes)]
        chosen = next(index for index, each in enumerate(episodes.values()) if each is self._timeline)
        self._panel.show_episodes(labels, labels[chosen])

    def _begin(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._player.restart()
        self._scene.begin(timeline)
        self._scene.show(self._timelines, timeline, self._player.row(timeline), follow=self._follows_robot)

    def _obey(self, command: Command) -> None:
        if command.name in LAYERS:
            self._scene.show_layer(command.name, bool(command.value))
        elif command.name == FOLLOW_ROBOT:
            self._follows_robot = bool(command.value)
        elif command.name == "camera":
            self._aim(command)
        elif command.name == "speed":
            self._player.speed = speed_of(command.value)
            if self._player.follows and self._timeline is not None:
                self._player.play(self._timeline)
        elif self._timeline is not None:
            self._obey_in_time(command, self._timeline)

    def _obey_in_time(self, command: Command, timeline: Timeline) -> None:
        player = self._player
        self._follows_newest = False
        match command.name:
            case "seek":
                player.seek(float(command.value), timeline)
            case "play":
                act: Callable[[], None] = player.pause if player.is_playing else lambda: player.play(timeline)
                act()
            case "live":
                self._follows_newest = True
                player.follow()
            case "jump":
                n = -1 if "<" in command.value else 1
                (player.move_steps if "|" in command.value else player.move_rows)(n, timeline)
            case "episode":
                index = int(str(command.value).partition(":")[0])
                self._begin(list(self._timelines.episodes.values())[index])
            case _:
                raise ConfigError(f"Expected a command of the page, got {command.name}")

    def _aim(self, command: Command) -> None:
        """Of whoever asked for it, and nobody else."""
        client = command.client
        if client is None:
            return
        camera = CAMERAS[str(command.value)]
        with client.atomic():
            client.camera.position = self._from_robot(camera.position_m)
            client.camera.look_at = self._from_robot(camera.look_at_m)

    def _from_robot(self, point_m: tuple[float, float, float]) -> tuple[float, float, float]:
        """A point in the frame of the robot, on the floor below it, in that of the page."""
        if self._timeline is None:
            return point_m
        trunk = self._timeline.qpos[self._player.row(self._timeline), TRUNK]
        yaw = float(rpy_from_quaternion(trunk[3:])[2])
        away_x, away_y = (0.0, 0.0) if self._follows_robot else (float(trunk[0]), float(trunk[1]))
        x, y, z = point_m
        return away_x + cos(yaw) * x - sin(yaw) * y, away_y + sin(yaw) * x + cos(yaw) * y, z


def _free_port(host: str, port: int) -> int:
    """The port, or any if it is 0; `ConfigError` where nobody can listen there."""
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((host, port))
            return int(probe.getsockname()[1])
    except OSError as error:
        raise ConfigError(
            f"Expected an address to listen on for --host and --port, got {host}:{port} ({error.strerror}); "
            "--port 0 takes any port that is free"
        ) from error
